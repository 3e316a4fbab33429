//! The link over USB: one CDC-ACM serial port, whose bytes the application reads and writes.
//!
//! Nothing here is a safety measure. Many hosts never raise DTR, an STM32 does not notice when its cable is pulled, and
//! a suspended laptop looks like an idle one. The dead-man's switch in the application protects the drive. So DTR is
//! not read, and a read waits without a limit. A write waits too, but the application drops it with its reply when the
//! host has not taken it in time: a host that has stopped reading must not stop the program.

use cortex_m::peripheral::DWT;
use embassy_executor::Spawner;
use embassy_futures::select::select;
use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_stm32::peripherals::{PA11, PA12, USB_OTG_FS};
use embassy_stm32::usb::{self, Driver};
use embassy_stm32::{Peri, bind_interrupts, pac};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_usb::class::cdc_acm::{CdcAcmClass, Receiver, Sender, State};
use embassy_usb::driver::EndpointError;
use embassy_usb::{Builder, Handler, UsbDevice};
use embedded_io_async::{ErrorKind, ErrorType, Read, Write};
use slipline_app::ports::UsbFrame;
use static_cell::StaticCell;

use crate::usb_control::{Guarded, PACKET};
use crate::{board, priority};

/// The test pair of pid.codes: 0x1209 is its vendor id; anyone may use product 0x0001 for development, but must not
/// ship it. A product needs its own pair; the udev rule and the host's port search use this one.
const VENDOR: u16 = 0x1209;
const PRODUCT: u16 = 0x0001;

/// Bytes of the receive buffers of the control and the bulk OUT endpoint; they need 2 packets.
const OUT_BUFFERS: usize = 4 * PACKET;

bind_interrupts!(struct Irqs {
    OTG_FS => NewBeginning, usb::InterruptHandler<USB_OTG_FS>;
});

/// The driver of the OTG core.
type Otg = Guarded<Driver<'static, USB_OTG_FS>>;

/// The OTG core that has its own full-speed PHY, on its pins.
pub(crate) struct Usb {
    pub(crate) core: Peri<'static, USB_OTG_FS>,
    pub(crate) dp: Peri<'static, PA12>,
    pub(crate) dm: Peri<'static, PA11>,
}

/// Sets up the USB device, with the chip's unique id as serial number; returns the port's two directions.
pub(crate) fn start(spawner: Spawner, usb: Usb) -> (FromHost, ToHost) {
    static OUT: StaticCell<[u8; OUT_BUFFERS]> = StaticCell::new();
    static CONFIGURATION: StaticCell<[u8; 256]> = StaticCell::new();
    static BOS: StaticCell<[u8; 32]> = StaticCell::new();
    static CONTROL: StaticCell<[u8; PACKET]> = StaticCell::new();
    static STATE: StaticCell<State<'static>> = StaticCell::new();
    static BUS_RESET: StaticCell<BusReset> = StaticCell::new();

    // 5 V on the cable do not show that the host runs: only the dead-man's switch does. So VBUS sensing stays off and
    // its pin, PA9, stays free.
    let mut sense = usb::Config::default();
    sense.vbus_detection = false;
    let driver =
        Guarded::new(Driver::new_fs(usb.core, Irqs, usb.dp, usb.dm, OUT.init([0; OUT_BUFFERS]), sense));
    let mut config = embassy_usb::Config::new(VENDOR, PRODUCT);
    config.manufacturer = Some("Slipline");
    config.product = Some("Slipline tactile display");
    config.serial_number = Some(embassy_stm32::uid::uid_hex());
    // Boards take less than 100 mA from the bus; the amplifier has its own supply.
    config.max_power = 200;
    config.max_packet_size_0 = PACKET as u8;

    let mut builder = Builder::new(
        driver,
        config,
        CONFIGURATION.init([0; 256]),
        BOS.init([0; 32]),
        &mut [],
        CONTROL.init([0; PACKET]),
    );
    builder.handler(BUS_RESET.init(BusReset));
    let class = CdcAcmClass::new(&mut builder, STATE.init(State::new()), PACKET as u16);
    let (sender, receiver) = class.split();
    interrupt::OTG_FS.set_priority(priority::USB);
    if let Ok(task) = run(builder.build()) {
        spawner.spawn(task);
    }
    (FromHost { receiver, packet: [0; PACKET], start: 0, end: 0 }, ToHost(sender))
}

/// How long a frame is waited for: two frames, in cycles. Should the cycle counter stand still, the looks end it.
const FRAME_CYCLES: u32 = board::CORE_HZ / 500;
const FRAME_LOOKS: u32 = 200_000;

/// The frame that the host begins next, with the cycle counter then; `None` if it begins none.
pub(crate) fn next_frame() -> Option<UsbFrame> {
    // DSTS.FNSOF, of which full speed uses 11 bits (RM0090 34.16.4).
    let number = || pac::USB_OTG_FS.dsts().read().fnsof() & 0x7ff;
    let (before, begun) = (number(), DWT::cycle_count());
    for _ in 0..FRAME_LOOKS {
        let (number, cycles) = (number(), DWT::cycle_count());
        if number != before {
            return Some(UsbFrame { number, cycles });
        }
        if cycles.wrapping_sub(begun) > FRAME_CYCLES {
            break;
        }
    }
    None
}

/// IN endpoints that every core has, the control endpoint included (F407: four, RM0090 34.3; H743: nine).
const IN_ENDPOINTS: usize = 4;

/// Withdraws a packet that the host has not fetched and never will.
///
/// The driver flushes the endpoint's FIFO but leaves EPENA set (embassy-usb-synopsys-otg 0.3), and its `write` waits
/// until the core clears EPENA. The core clears it when the packet has been sent. A flushed packet is never sent, so
/// the device would not answer until the power is switched off and on.
fn withdraw(endpoint: usize) {
    let control = pac::USB_OTG_FS.diepctl(endpoint);
    if control.read().epena() {
        // RM0090, 34.17.6: an IN endpoint is disabled by EPDIS, with NAK set.
        control.modify(|w| {
            w.set_snak(true);
            w.set_epdis(true);
        });
    }
}

/// Withdraws every packet that the host had not fetched when it reset the bus.
struct BusReset;

impl Handler for BusReset {
    fn reset(&mut self) {
        (0..IN_ENDPOINTS).for_each(withdraw);
    }
}

/// A bus reset or the first packet of a control transfer has come.
static BEGINS: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// Raises [`BEGINS`], and withdraws the end of the transfer before if the host has not fetched that. It must run before the
/// driver's handler, which lets the next transfer begin.
///
/// It also forgets a suspension that the driver has not reported yet: the bus is awake. During a control transfer nobody asks
/// for bus events. The driver would report the reset first and the earlier suspension after it; then embassy-usb answers
/// no request until the next reset.
struct NewBeginning;

impl interrupt::typelevel::Handler<interrupt::typelevel::OTG_FS> for NewBeginning {
    unsafe fn on_interrupt() {
        let core = pac::USB_OTG_FS;
        let is_setup = core.doepint(0).read().stup();
        if is_setup {
            withdraw(0);
        }
        if is_setup || core.gintsts().read().usbrst() {
            // Written as 1, it is cleared.
            core.gintsts().write(|w| w.set_usbsusp(true));
            BEGINS.signal(());
        }
    }
}

/// First packets of control transfers that the core can keep. It counts down with each that comes, and the driver sets it to
/// this when it takes one (RM0090, 34.17.5).
const SETUPS: u8 = 3;

/// Waits until the host has given a control transfer up: it restarts, and the driver does not see it.
///
/// In a control transfer the driver waits for the host's next step and for nothing else (embassy-usb 0.6). A host that gives
/// one up, by a new one (USB 2.0, 8.5.3) or by a reset of the bus, would get no answer until the power is switched off and
/// on.
async fn given_up() {
    loop {
        BEGINS.wait().await;
        let core = pac::USB_OTG_FS;
        if core.gintsts().read().usbrst() || core.doeptsiz(0).read().rxdpid_stupcnt() < SETUPS {
            return;
        }
    }
}

/// Runs the USB device; never ends.
#[embassy_executor::task]
async fn run(mut device: UsbDevice<'static, Otg>) {
    loop {
        // `select` asks the device first: it takes all that it can take. What it has left then, it would leave for ever. A bus
        // reset and a first packet stay where they are for the next run.
        select(device.run(), given_up()).await;
        withdraw(0);
    }
}

/// There is no host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NotConnected;

impl core::fmt::Display for NotConnected {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("no USB host")
    }
}

impl core::error::Error for NotConnected {}

impl embedded_io_async::Error for NotConnected {
    fn kind(&self) -> ErrorKind {
        ErrorKind::NotConnected
    }
}

/// Bytes from the host.
pub(crate) struct FromHost {
    receiver: Receiver<'static, Otg>,
    packet: [u8; PACKET],
    start: usize,
    end: usize,
}

impl ErrorType for FromHost {
    type Error = NotConnected;
}

impl Read for FromHost {
    /// Waits for bytes, and for a host first if there is none. Dropping the future loses nothing: a packet is taken
    /// out of the endpoint and into `self` in one step.
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, NotConnected> {
        while self.start == self.end {
            match self.receiver.read_packet(&mut self.packet).await {
                Ok(length) => (self.start, self.end) = (0, length),
                // Unconfigured or re-enumerated.
                Err(EndpointError::Disabled) => self.receiver.wait_connection().await,
                // The buffer is as long as the longest packet.
                Err(EndpointError::BufferOverflow) => {}
            }
        }
        let waiting = self.packet.get(self.start..self.end).unwrap_or_default();
        let taken = waiting.len().min(buffer.len());
        for (to, from) in buffer.iter_mut().zip(waiting) {
            *to = *from;
        }
        self.start += taken;
        Ok(taken)
    }
}

/// Bytes to the host.
pub(crate) struct ToHost(Sender<'static, Otg>);

impl ErrorType for ToHost {
    type Error = NotConnected;
}

impl Write for ToHost {
    /// Hands over the next packet. Dropping the future before it is done sends nothing: the driver fills the
    /// endpoint's FIFO in one step, after its waits.
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, NotConnected> {
        // Never a full packet: the host would keep it back until a shorter one follows.
        let packet = bytes.get(..bytes.len().min(PACKET - 1)).unwrap_or_default();
        self.0.write_packet(packet).await.map_err(|_| NotConnected)?;
        Ok(packet.len())
    }

    /// Every packet is on its way when `write` returns.
    async fn flush(&mut self) -> Result<(), NotConnected> {
        Ok(())
    }
}
