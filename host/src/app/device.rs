//! The device as the app steers it: which port, what its snapshot changes, the table and the drive it is sent. When
//! the app asks by itself is the [`pilot`]'s affair.

use super::{App, Notice, TableJob, TableState};
use crate::edit;
use crate::link::{Port, Request, Snapshot};
use crate::pilot;
use std::sync::Arc;

impl App {
    pub(super) fn connect(&mut self, port: Port) {
        // The port that was asked for is remembered even if it is not there today.
        self.settings.port = Some(port.to_string());
        self.pilot.connecting(&port);
        self.parts.link.send(Request::Connect(port));
    }

    pub(super) fn look_at_link(&mut self) {
        let snapshot = self.parts.link.snapshot();
        let before = std::mem::replace(&mut self.snapshot, snapshot);
        if before.revision == self.snapshot.revision {
            let now = |snapshot: &Snapshot| snapshot.status.map(|status| status.now);
            if self.hearing.sounding.is_some() && now(&before) != now(&self.snapshot) {
                self.follow();
            }
            return;
        }
        self.settings.auto_reconnect = self.snapshot.auto_reconnect;
        if let Some((ticket, reason)) = &self.snapshot.last_refusal
            && before.last_refusal.as_ref().map(|(ticket, _)| ticket) != Some(ticket)
        {
            self.notice =
                Some(Notice { text: format!("Refused: {reason}"), is_error: true, is_refusal: true });
        }
        self.ask_for_table();
        self.let_pilot_act(&before);
        self.hear();
    }

    fn let_pilot_act(&mut self, before: &Snapshot) {
        let made = self.table.made().filter(|made| Arc::ptr_eq(&made.plate, &self.setup.plate));
        for act in self.pilot.look(before, &self.snapshot, made, &self.settings) {
            match act {
                pilot::Act::Upload(table) => {
                    self.parts.link.send(Request::Upload(table));
                }
                pilot::Act::Drive => self.send_drive(),
            }
        }
    }

    /// Has the table made for the plate on the screen and the device's rate, unless it was asked for.
    pub(super) fn ask_for_table(&mut self) {
        let Some(identity) = &self.snapshot.identity else { return };
        let rate = identity.sample_rate_hz;
        let is_asked = self
            .table_asked
            .as_ref()
            .is_some_and(|(plate, asked)| Arc::ptr_eq(plate, &self.setup.plate) && *asked == rate);
        if is_asked {
            return;
        }
        self.table_asked = Some((Arc::clone(&self.setup.plate), rate));
        self.table = TableState::Making;
        self.parts.tables.ask(TableJob {
            plate: Arc::clone(&self.setup.plate),
            sample_rate_hz: f64::from(rate),
            max_knots: usize::from(identity.max_knots),
        });
    }

    /// Takes a table that was made, unless the screen shows another plate by now.
    pub(super) fn take_table(&mut self) {
        let Some(table) = self.parts.tables.take() else { return };
        let is_current = table.made().is_none_or(|made| Arc::ptr_eq(&made.plate, &self.setup.plate));
        if is_current {
            self.background.keep(&table);
            self.table = table;
            self.predict();
            let snapshot = Arc::clone(&self.snapshot);
            self.let_pilot_act(&snapshot);
            self.hear();
        }
    }

    pub(super) fn send_drive(&mut self) {
        self.parts.link.send(Request::Drive(edit::drive(&self.setup)));
    }

    pub(super) fn stop(&mut self) {
        self.pilot.stopped();
        self.parts.link.send(Request::Stop);
    }
}
