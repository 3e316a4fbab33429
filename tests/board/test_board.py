"""What must hold of the flashed image, on a register-level board (RELIABILITY of the device, sections B, D and E)."""
import struct

import pytest

from copies import on_copy
from core.processor import PowerCut
from core.usb import UsbHost
from host import (
    BOOTLOADER_ENTER, BOOTLOADER_TOKEN, DISARM, DRIVE, HELLO, KEEP_ALIVE, RATE_HZ, STOP, STORE, TABLE_DIGEST, TABLE_REPLY,
    TOKEN_REPLY, Reader, drive, frame, hello_body, varint,
)  # fmt: skip

MID = 2048
MILLISECOND = RATE_HZ // 1000
# On all three chips: UART5, whose vector the renderer has, the DAC's underrun, and the time's timer.
RENDERER_IRQ, DAC_IRQ, TIME_IRQ = 53, 54, 50


def sixteen(shift=0.0):
    return [(slot, (slot + shift) / 17, 0.06) for slot in range(16)]


def start(rig, tones=((0, 0.4, 0.5),), glide=5 * MILLISECOND):
    """Drives, and returns the index from which on it sounds."""
    at = rig.host.accept(DRIVE, drive(list(tones), glide))
    rig.host.live(0.02)
    return at


def at_each_reset(rig):
    """A list that gets the mute pin's level and the DAC's code at each reset, as they are just before it: a reset lets the
    pin float, so afterwards nobody can tell."""
    seen, reset = [], rig.board.reset
    rig.board.reset = lambda cause: (seen.append((rig.board.pin(rig.facts.unmute), rig.board.dac.output)), reset(cause))
    return seen


def is_silent(codes):
    return bool(codes) and set(codes) == {MID}


@pytest.mark.every_image
def test_it_boots_muted_and_the_dac_is_at_mid_scale_long_before_anything_could_unmute(rig):
    rig.board.run(0.02)
    unmute = rig.facts.unmute
    pins = [entry for entry in rig.board.log if entry[1] == unmute]
    driven = [entry for entry in rig.board.log if entry[1] == "dac drives"]
    assert [entry[2] for entry in pins] == [0], "the mute pin goes low and stays"
    assert [entry[2] for entry in driven] == [MID], "the first voltage is mid-scale"
    rig.host.connect()
    rig.host.upload()
    rig.host.arm()
    unmuted = next(entry for entry in rig.board.log if entry[1] == unmute and entry[2] == 1)
    assert unmuted[0] > driven[0][0]
    assert is_silent(rig.board.dac.codes)


@pytest.mark.every_image
def test_it_plays_400_000_codes_a_second(rig):
    rig.board.run(0.01)
    before = len(rig.board.dac.codes)
    rig.board.run(0.05)
    assert abs(len(rig.board.dac.codes) - before - 20_000) <= 1
    assert rig.board.dac.underruns == 0


def test_it_enumerates_as_the_documentation_says(rig):
    identity = rig.host.connect()
    unique_id = b"SLIPLINE-VB1"
    if isinstance(rig.cable, UsbHost):
        vendor, product = struct.unpack_from("<HH", rig.cable.descriptor, 8)
        assert (vendor, product) == (0x1209, 0x0001)
        assert rig.cable.strings == {1: "Slipline", 2: "Slipline tactile display", 3: unique_id.hex().upper()}
    assert identity["board"] == rig.facts.name
    assert identity["unit"] == unique_id
    assert (identity["rate"], identity["block"], identity["bits"], identity["tones"]) == (RATE_HZ, 128, 12, 16)
    assert (identity["reset"], identity["stored"], identity["crash"]) == ("power-on", "empty", "")
    assert not identity["simulated"]


def test_the_renderer_ranks_above_the_link_and_the_dac_above_both(rig):
    rig.board.run(0.01)
    irqs = {"dma": rig.facts.dma_irq, "dac": DAC_IRQ, "renderer": RENDERER_IRQ, "time": TIME_IRQ, "link": rig.facts.link_irq}
    level = {name: rig.board.priorities[irq] for name, irq in irqs.items()}
    assert level["dma"] == level["dac"] < level["renderer"] < level["time"]
    if isinstance(rig.cable, UsbHost):
        assert level["renderer"] < level["link"], "the host waits"
    else:
        assert level["dma"] < level["link"] < level["renderer"], "a byte would be lost"


def test_sixteen_gliding_tones_are_the_mirrors_bit_for_bit(cool, mirror):
    armed = cool
    first = armed.host.status()["now"] + 5 * MILLISECOND
    first = armed.host.accept(DRIVE, drive(sixteen(), 10 * MILLISECOND, first))
    armed.host.live(0.03)
    drag = armed.host.accept(DRIVE, drive(sixteen(0.9), 40 * MILLISECOND))
    armed.host.live(0.08)
    stop = armed.host.accept(STOP)
    armed.host.live(0.04)
    until = armed.played()
    assert first < drag < stop and until - first > 100 * MILLISECOND
    codes = armed.codes(first, until)
    expected = mirror(armed.host.accepted, first, until)
    wrong = [i for i, (a, b) in enumerate(zip(codes, expected, strict=True)) if a != b]
    assert not wrong, f"{len(wrong)} codes differ, the first at {wrong[0]}, drive {first}, drag {drag}, stop {stop}"
    assert max(codes) - min(codes) > 2000, "it sounds"
    assert is_silent(codes[-MILLISECOND:]), "and stops"
    status = armed.host.status()
    assert (status["state"], status["underruns"], armed.board.dac.underruns) == ("armed", 0, 0)
    # The deadline is a block, and the link wants the other half.
    print(f"worst block: {status['max_cycles']} cycles of {armed.board.CORE_HZ * 128 / RATE_HZ:.0f}")
    assert 0 < status["max_cycles"] < 0.5 * 128 / RATE_HZ * armed.board.CORE_HZ


@pytest.mark.every_image
def test_a_silent_host_is_noticed_by_the_device_itself(armed):
    """R-20: nothing about USB tells it, the cable stays in and the port open."""
    start(armed)
    last = armed.played()
    armed.host.lives = False
    armed.board.is_hasty = True
    armed.board.run(0.95)
    assert not is_silent(armed.codes(armed.played() - MILLISECOND, armed.played())), "not before its time"
    armed.board.run(0.3)
    assert is_silent(armed.codes(last + 1060 * MILLISECOND, armed.played()))
    assert armed.board.pin(armed.facts.unmute) == 0
    status = armed.host.status()
    assert (status["state"], status["first_fault"]) == ("fault", "host lost")


def test_a_pulled_cable_ends_in_silence_and_a_new_session(armed):
    """R-20, R-21, R-22."""
    start(armed)
    armed.cable.unplug()
    armed.board.is_hasty = True
    armed.board.run(1.3)
    assert armed.board.pin(armed.facts.unmute) == 0
    assert is_silent(armed.codes(armed.played() - MILLISECOND, armed.played()))
    armed.cable.plug()
    armed.host.inbox.clear()
    armed.host.connect()
    status = armed.host.status()
    assert (status["state"], status["first_fault"]) == ("fault", "host lost")
    assert armed.board.resets == [], "no watchdog, no crash"


def test_a_host_that_stops_reading_does_not_touch_the_samples(cool, mirror):
    """R-11."""
    armed = cool
    at = start(armed)
    armed.cable.reads = False
    for count in range(100, 112):
        body = varint(count)
        armed.cable.send(frame(armed.host.session, armed.host.sequence, KEEP_ALIVE, body))
        armed.board.run(0.01)
    until = armed.played()
    assert armed.codes(at, until) == mirror(armed.host.accepted, at, until)
    armed.cable.reads = True
    armed.board.run(0.05)
    # What was cut off in the middle is over with the next delimiter.
    armed.host.inbox.clear()
    armed.cable.receive()
    armed.host.keep_alives = 200
    status = armed.host.status()
    armed.host.accept(STOP)
    assert status["dropped"] > 0 and status["state"] == "driving" and status["underruns"] == 0


def test_a_bus_reset_while_a_reply_is_cut_does_not_stop_the_program(rig):
    """R-22. The host takes no packet, so the rest of the reply is dropped after its time: only a delimiter is owed. The
    bus reset disables the endpoint, and every write fails at once. Afterwards the first packet, which was never
    fetched, must not block the endpoint."""
    if not isinstance(rig.cable, UsbHost):
        pytest.skip("there is no bus on a serial line")
    rig.host.connect()
    rig.cable.reads = False
    rig.cable.send(frame(0, 0, HELLO, hello_body(99)))
    rig.board.run(0.1)
    rig.cable.unplug()
    rig.board.run(0.01)
    rig.cable.plug()
    # The host does not configure the device, as a computer that boots: nobody enables the endpoint.
    rig.cable.enumerates = False
    rig.board.is_hasty = True
    rig.board.run(2.0)
    assert rig.board.resets == [], "the supervisor has fed the watchdog"
    rig.cable.enumerates = rig.cable.reads = True
    rig.cable.unplug()
    rig.cable.plug()
    rig.board.is_hasty = False
    rig.host.inbox.clear()
    rig.host.connect()
    assert rig.host.status()["state"] == "idle"


def test_a_dma_that_does_not_deliver_is_counted_and_fades_out(armed):
    """R-43: the DAC's own underrun flag."""
    start(armed)
    controller, stream = armed.facts.dma
    armed.board.dma[controller].blocked.add(stream)
    armed.board.run(0.00002)
    armed.board.dma[controller].blocked.clear()
    before = len(armed.board.dac.codes)
    armed.board.run(0.1)
    codes = armed.board.dac.codes[before:]
    assert armed.board.dac.underruns >= 1
    assert len(codes) > 35_000 and is_silent(codes[-MILLISECOND:]), "the stream runs again"
    assert max(abs(a - b) for a, b in zip(codes, codes[1:])) < 700, "and nothing jumps"
    status = armed.host.status()
    assert status["first_fault"] == "underrun"
    assert status["underruns"] == 1, "one event, counted once"
    assert armed.board.pin(armed.facts.unmute) == 0


def line(code, length):
    """The codes from `code`, which is not one of them, to mid-scale: four codes a sample (firmware/app/src/fade.rs)."""
    codes = []
    for _ in range(length):
        code = max(code - 4, MID) if code > MID else min(code + 4, MID)
        codes.append(code)
    return codes


def test_a_renderer_that_is_late_leaves_the_tone_by_one_line_and_never_comes_back_to_it(sounding):
    """R-43. The delay is held at each of the 128 phases by a model of the ring (firmware/stm32/src/ring/tests.rs)."""

    def late(rig, samples):
        board = rig.board
        board.enabled.discard(RENDERER_IRQ)
        board.run(samples / RATE_HZ)
        board.enabled.add(RENDERER_IRQ)
        board.run(0.004)
        left = rig.leaves_the_mirror()
        after = rig.codes(left, rig.played())
        is_late = bool(after)
        if is_late:
            assert len(after) > 1000 and after == line(rig.codes(left - 1, left)[0], len(after)), f"left at {left - rig.at}"
            assert (left - rig.at) % 128 == 0, "a block is played whole or not at all"
            assert board.pin(rig.facts.unmute) == 0, "no ramp comes after the fault"
            assert board.dac.underruns == 0, "the DMA itself was on time"
        status = rig.host.status()
        assert (status["first_fault"] == "underrun") == is_late == (status["underruns"] > 0)
        return is_late

    held = [10, *range(100, 230, 13), 400]
    were_late = [on_copy(sounding, lambda rig, samples=samples: late(rig, samples)) for samples in held]
    assert were_late == sorted(were_late) and not were_late[0] and were_late[-1], dict(zip(held, were_late))


def test_a_panic_mutes_first_and_is_told_at_the_next_hello(armed):
    """R-51."""
    start(armed)
    armed.facts.break_program(armed)
    armed.board.run_until(lambda: armed.board.resets, 0.01, step=0.0001)
    assert armed.board.resets == ["software"]
    low = max(entry[0] for entry in armed.board.log if entry[1] == armed.facts.unmute and entry[2] == 0)
    assert low <= armed.board.seconds
    armed.host.inbox.clear()
    identity = armed.host.connect()
    assert identity["reset"] == "panic"
    assert armed.facts.crash in identity["crash"], identity["crash"]
    status = armed.host.status()
    assert "crash" in status["faults"] and status["state"] == "fault"
    assert armed.board.pin(armed.facts.unmute) == 0


def test_mute_and_mid_scale_come_before_the_reset(armed):
    start(armed)
    seen = at_each_reset(armed)
    armed.facts.break_program(armed)
    armed.board.run_until(lambda: seen, 0.01, step=0.0001)
    assert seen == [(0, MID)]


def test_a_wild_jump_is_a_hard_fault_that_is_told(armed):
    start(armed)
    armed.board.pc = 0x60000001
    armed.board.run_until(lambda: armed.board.resets, 0.01, step=0.0001)
    identity = armed.host.connect()
    assert identity["reset"] == "hard fault"
    assert identity["crash"].startswith("fault at 0x6000000"), identity["crash"]


def test_a_stack_that_overflows_is_caught_and_told(armed):
    """The stack's memory has nothing below it."""
    from unicorn.arm_const import UC_ARM_REG_SP

    start(armed)
    armed.board.cpu.reg_write(UC_ARM_REG_SP, armed.board.STACK[0] + 8)
    armed.board.run_until(lambda: armed.board.resets, 0.05, step=0.0001)
    identity = armed.host.connect()
    assert identity["reset"] == "hard fault" and "stack overflow" in identity["crash"], identity["crash"]


def test_an_interrupt_without_a_handler_mutes_and_is_told(armed):
    """The window watchdog's: nothing of the firmware enables it."""
    start(armed)
    seen = at_each_reset(armed)
    armed.board.enabled.add(0)
    armed.board.pend(0)
    armed.board.run_until(lambda: seen, 0.01, step=0.0001)
    assert seen == [(0, MID)], "muted before the reset"
    identity = armed.host.connect()
    assert (identity["reset"], identity["crash"]) == ("hard fault", "unexpected exception 16")


def test_three_crashes_in_a_row_end_in_safe_mode(rig):
    for _ in range(3):
        rig.host.connect()
        rig.facts.break_program(rig)
        count = len(rig.board.resets)
        rig.board.run_until(lambda: len(rig.board.resets) > count, 0.01, step=0.0001)
        rig.host.inbox.clear()
    rig.host.connect()
    assert rig.host.status()["state"] == "safe mode"
    rig.board.reset("power")
    rig.host.inbox.clear()
    assert rig.host.connect()["reset"] == "power-on"
    assert rig.host.status()["state"] == "idle"


@pytest.mark.parametrize("frozen", ["renderer", "thread"])
def test_a_frozen_task_is_reset_by_the_watchdog(armed, frozen):
    """R-50."""
    start(armed)
    armed.board.is_hasty = True
    if frozen == "renderer":
        armed.board.enabled.discard(RENDERER_IRQ)
    else:
        armed.board.is_thread_frozen = True
    at = armed.board.seconds
    armed.board.run_until(lambda: armed.board.resets, 2 * armed.facts.watchdog_seconds, step=0.05)
    assert armed.board.resets == ["watchdog"]
    assert armed.board.seconds - at < armed.facts.watchdog_seconds + 0.3
    armed.host.inbox.clear()
    identity = armed.host.connect()
    assert identity["reset"] == "watchdog"
    assert "watchdog" in armed.host.status()["faults"]
    assert armed.board.pin(armed.facts.unmute) == 0


def test_a_dip_of_the_supply_mutes_and_is_told(armed):
    """R-56: at the threshold that the board's file derives."""
    start(armed)
    register, shift, level = armed.facts.detector
    assert armed.board.power.values[register] >> shift & 0b111 == level
    seen = at_each_reset(armed)
    assert armed.board.dip_supply(), "the detector is watched"
    armed.board.run_until(lambda: seen, 0.01, step=0.0001)
    assert seen == [(0, MID)], "muted before the reset"
    identity = armed.host.connect()
    assert identity["reset"] == "brown-out"


def stored_crc(rig):
    _, reply, body = rig.host.exchange(TABLE_DIGEST)
    assert reply == TABLE_REPLY
    reader = Reader(body)
    if not reader.byte():
        return None
    for _ in range(4):
        reader.number()
    return reader.number()


def keep(rig, count):
    """Uploads a table and stores it; returns its CRC."""
    rig.host.accept(DISARM)
    rig.host.live(0.1)
    crc = rig.host.upload(count)
    rig.host.live(0.05)
    rig.host.accept(STORE, patience=rig.facts.store_seconds)
    return crc


@pytest.mark.every_image
def test_the_table_survives_the_power_and_storing_it_is_no_underrun(rig):
    rig.host.connect()
    crc = keep(rig, 33)
    status = rig.host.status()
    assert (status["underruns"], status["faults"], rig.board.dac.underruns) == (0, set(), 0)
    rig.board.reset("power")
    identity = rig.host.connect()
    assert identity["stored"] == "loaded"
    assert stored_crc(rig) == crc
    assert rig.host.maintenance() == (1, 20_000, True)


@pytest.mark.every_image
def test_a_board_without_its_brown_out_level_says_so(rig):
    rig.board.flash.take_brown_out_level()
    rig.host.connect()
    assert rig.host.maintenance() == (0, 20_000, False)


def operation_at(facts, words):
    """The flash's operation during which the power goes: the first erasure, or where so many words of 4 bytes are written."""
    return facts.erasures - 1 + -(-4 * words // facts.word_bytes) if words else 0


@pytest.mark.parametrize("words", [0, 1, 2, 9, 40, *(pytest.param(words, marks=pytest.mark.every_image) for words in (75, 82))])
def test_a_power_cut_while_storing_leaves_the_old_or_the_new_table(rig, words):
    """R-35, R-36: the cut comes before the first erasure is over, between words, and in the last words; what it tears is
    half erased or half written, and cannot be corrected where the flash has error correction. The last eight of the 88
    words are the record's header, which the next start reads: the G474 gets its NMI and the H743 its bus fault then."""
    rig.host.connect()
    old = keep(rig, 33)
    rig.board.flash.cut_at = rig.board.flash.operations + operation_at(rig.facts, words)
    new = None
    with pytest.raises(PowerCut):
        new = keep(rig, 34)
    assert new is None
    rig.board.reset("power")
    rig.host.inbox.clear()
    identity = rig.host.connect()
    # Half an erasure of what was blank leaves no trace, where no word can become unreadable.
    is_told = words > 0 or rig.facts.word_bytes > 4
    assert identity["stored"] == ("fell back" if is_told else "loaded")
    assert rig.host.status()["faults"] == ({"store fell back"} if is_told else set())
    assert stored_crc(rig) == old
    again = keep(rig, 35)
    assert rig.host.maintenance()[0] == 2 + is_told
    rig.board.reset("power")
    identity = rig.host.connect()
    assert identity["stored"] == "loaded"
    assert stored_crc(rig) == again


def enter_bootloader(rig):
    rig.host.connect()
    _, reply, body = rig.host.exchange(BOOTLOADER_TOKEN)
    assert reply == TOKEN_REPLY
    rig.host.exchange(BOOTLOADER_ENTER, varint(Reader(body).number()))
    rig.board.run(0.1)
    assert rig.board.resets == ["software"]


def test_the_rom_bootloader_is_entered_in_two_steps(rig):
    """R-63."""
    enter_bootloader(rig)
    assert rig.board.pc & ~1 == rig.facts.rom + 0x100
    assert rig.board.vectors == rig.facts.rom, "the ROM's interrupts are the ROM's"
    if rig.facts.rom_map:
        register, mode = rig.facts.rom_map
        assert rig.board.bus_read(register, 4) & 7 == mode, "system memory at address 0, as after a boot from ROM"
    rig.board.reset("pin")
    rig.host.inbox.clear()
    rig.host.connect()


def test_the_program_runs_when_the_rom_bootloader_starts_it_by_a_jump(rig):
    """`dfu-util -s 0x08000000:leave` resets nothing."""
    enter_bootloader(rig)
    rig.board.leave_bootloader()
    rig.host.inbox.clear()
    identity = rig.host.connect()
    assert (identity["reset"], identity["crash"]) == ("software", "")
    assert rig.board.resets == ["software"], "the one that led into the ROM"
    rig.host.upload()
    rig.host.arm()


def test_the_lamp_tells_muted_from_sounding(armed):
    def flashes(seconds):
        armed.board.log.clear()
        armed.host.live(seconds)
        return sum(1 for entry in armed.board.log if entry[1] == armed.facts.lamp and entry[2] == 1)

    armed.board.is_hasty = True
    armed.host.live(0.2)
    assert flashes(0.9) == 0 and armed.board.pin(armed.facts.lamp) == 1, "steady while the amplifier is on"
    armed.host.accept(DISARM)
    armed.host.live(0.9)
    assert flashes(1.6) == 2, "a flash every 0.8 s while it is muted"


def test_the_lamp_tells_that_the_brown_out_level_is_not_set(rig):
    """R-56: as chips leave the factory. Nothing but the lamp tells it."""
    mask, delivered = rig.facts.brown_out
    rig.board.flash.options = rig.board.flash.options & ~mask | delivered
    rig.board.reset("power")
    rig.board.is_hasty = True
    rig.board.run(0.15)
    rig.board.log.clear()
    rig.board.run(0.8)
    assert sum(1 for entry in rig.board.log if entry[1:] == (rig.facts.lamp, 1)) == 2, "muted alone is one flash in 0.8 s"
