//! A USB driver with a control pipe that tolerates any behaviour of the host.
//!
//! embassy-usb 0.6 on embassy-usb-synopsys-otg 0.3 trusts its host in three points:
//! - A request to an endpoint that the chip does not have fails an assertion: one packet would reset the device.
//! - A packet that is longer than the request announced stays in the driver's buffer. No packet fits into the buffer any more,
//!   and every later transfer fails, until the power is switched off and on.
//! - A packet of a transfer that is over is taken for the first one of the next transfer.
//!
//! So the control pipe stands between the two, and the rest of the driver is used as it is.

use core::future::Future;
use core::pin::pin;

use embassy_futures::poll_once;
use embassy_usb::driver::{
    ControlPipe, Driver, Endpoint, EndpointAddress, EndpointAllocError, EndpointError, EndpointType,
};

/// Bytes of the control endpoint's longest packet.
pub(crate) const PACKET: usize = 64;

/// A driver with such a control pipe.
pub(crate) struct Guarded<D> {
    driver: D,
    endpoints: Endpoints,
}

impl<D> Guarded<D> {
    pub(crate) fn new(driver: D) -> Self {
        Self { driver, endpoints: Endpoints::CONTROL }
    }
}

impl<'d, D: Driver<'d>> Driver<'d> for Guarded<D> {
    type EndpointOut = D::EndpointOut;
    type EndpointIn = D::EndpointIn;
    type ControlPipe = GuardedPipe<D::ControlPipe>;
    type Bus = D::Bus;

    fn alloc_endpoint_out(
        &mut self,
        kind: EndpointType,
        address: Option<EndpointAddress>,
        max_packet_size: u16,
        interval_ms: u8,
    ) -> Result<D::EndpointOut, EndpointAllocError> {
        let endpoint = self.driver.alloc_endpoint_out(kind, address, max_packet_size, interval_ms)?;
        self.endpoints.add(endpoint.info().addr);
        Ok(endpoint)
    }

    fn alloc_endpoint_in(
        &mut self,
        kind: EndpointType,
        address: Option<EndpointAddress>,
        max_packet_size: u16,
        interval_ms: u8,
    ) -> Result<D::EndpointIn, EndpointAllocError> {
        let endpoint = self.driver.alloc_endpoint_in(kind, address, max_packet_size, interval_ms)?;
        self.endpoints.add(endpoint.info().addr);
        Ok(endpoint)
    }

    fn start(self, control_max_packet_size: u16) -> (D::Bus, Self::ControlPipe) {
        let (bus, pipe) = self.driver.start(control_max_packet_size);
        (bus, GuardedPipe { pipe, endpoints: self.endpoints })
    }
}

/// A set of endpoints: bit n is OUT endpoint n, bit 16 + n is IN endpoint n.
#[derive(Clone, Copy)]
struct Endpoints(u32);

impl Endpoints {
    /// Both directions of the control endpoint.
    const CONTROL: Self = Self(1 | 1 << 16);

    fn bit(address: u8) -> u32 {
        1 << ((address & 0x0f) + if address & 0x80 == 0 { 0 } else { 16 })
    }

    fn add(&mut self, address: EndpointAddress) {
        self.0 |= Self::bit(address.into());
    }

    /// Whether a request may be handed over: it is not a standard one to an endpoint, or the endpoint exists.
    fn know(self, setup: [u8; 8]) -> bool {
        /// Of the request's type: not the direction. A standard request to an endpoint is 2 (USB 2.0, table 9-2).
        const KIND: u8 = 0x7f;
        let [kind, _, _, _, address, ..] = setup;
        kind & KIND != 2 || self.0 & Self::bit(address) != 0
    }
}

/// A control pipe that tolerates any behaviour of the host.
pub(crate) struct GuardedPipe<P> {
    pipe: P,
    endpoints: Endpoints,
}

impl<P: ControlPipe> ControlPipe for GuardedPipe<P> {
    fn max_packet_size(&self) -> usize {
        self.pipe.max_packet_size()
    }

    /// A request to an endpoint that does not exist is answered with a stall (USB 2.0, 9.4), and the next one is waited for.
    async fn setup(&mut self) -> [u8; 8] {
        loop {
            let setup = core::future::poll_fn(|context| {
                // The core takes no data between a setup packet and the moment in which the driver hands it over. So what is
                // in the buffer before that is left over, if nothing comes in between.
                cortex_m::interrupt::free(|_| {
                    let _ = poll_once(self.pipe.data_out(&mut [0; PACKET], true, true));
                    pin!(self.pipe.setup()).poll(context)
                })
            })
            .await;
            if self.endpoints.know(setup) {
                return setup;
            }
            self.pipe.reject().await;
        }
    }

    /// A packet longer than `buffer` is thrown away, and the request answered with a stall.
    async fn data_out(&mut self, buffer: &mut [u8], first: bool, last: bool) -> Result<usize, EndpointError> {
        let mut packet = [0; PACKET];
        let length = self.pipe.data_out(&mut packet, first, last).await?;
        if let (Some(to), Some(from)) = (buffer.get_mut(..length), packet.get(..length)) {
            to.copy_from_slice(from);
            return Ok(length);
        }
        self.pipe.reject().await;
        Err(EndpointError::BufferOverflow)
    }

    /// After the last packet the host sends an empty one. The driver keeps one that is not empty, so it is read here.
    async fn data_in(&mut self, data: &[u8], first: bool, last: bool) -> Result<(), EndpointError> {
        self.pipe.data_in(data, first, false).await?;
        if last {
            self.pipe.data_out(&mut [0; PACKET], true, true).await?;
        }
        Ok(())
    }

    async fn accept(&mut self) {
        self.pipe.accept().await;
    }

    async fn reject(&mut self) {
        self.pipe.reject().await;
    }

    async fn accept_set_address(&mut self, address: u8) {
        self.pipe.accept_set_address(address).await;
    }
}
