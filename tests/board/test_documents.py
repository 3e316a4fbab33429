"""What firmware/BOARDS.md and the udev rule say is true."""
import re

import pytest
from elftools.elf.elffile import ELFFile

from boards import RENDERER_IRQ, on_f407
from images import ROOT, firmware
from host import BLOCK, chord, comb, drive
from measuring import listen, listened
from messages import DigestStart

TEXT = (ROOT / "firmware/BOARDS.md").read_text()
RULES = (ROOT / "host/link/70-slipline.rules").read_text()
BOARDS = re.findall(r"^(board-[\w-]+) = ", (ROOT / "firmware/stm32/Cargo.toml").read_text(), re.M)
ALLOCATED, NO_BITS = 2, "SHT_NOBITS"
# A table in the documents may lag a little behind the code; the stack's by some words only.
TOLERANCE, STACK_TOLERANCE = 0.10, 64
FLASH = range(0x08000000, 0x08200000)
# Bytes of variables whose initial values lie in the flash: embassy's are some hundred.
MOST_DATA = 512


def sizes(path):
    """Bytes of flash and of RAM, stack not counted. What is copied from flash to RAM counts in both."""
    flash = ram = 0
    with open(path, "rb") as file:
        for section in ELFFile(file).iter_sections():
            if section["sh_flags"] & ALLOCATED:
                flash += section["sh_size"] if section["sh_type"] != NO_BITS else 0
                ram += section["sh_size"] if section["sh_addr"] not in FLASH else 0
    return flash, ram


def documented(row):
    """The numbers in a row of the sizes' table."""
    line = next(line for line in TEXT.splitlines() if line.startswith(f"| `{row}`"))
    return [int(number.replace(" ", "")) for number in re.findall(r"\d[\d ]*(?= \|)", line)]


def agrees(stated, true):
    return abs(stated - true) <= TOLERANCE * true


@pytest.mark.parametrize("board", BOARDS)
def test_the_sizes_in_the_documents_are_the_images(board):
    flash, ram = sizes(firmware(board))
    stated = documented(board)
    print(f"{board}: {flash} bytes of flash, {ram} bytes of RAM")
    assert agrees(stated[0], flash) and agrees(stated[1], ram), f"documented {stated}, built {flash}, {ram}"


@pytest.mark.parametrize("board", BOARDS)
def test_no_image_keeps_zeros_for_its_variables_in_the_flash(board):
    """A large state that is zero but for some bytes is set up by the start."""
    with open(firmware(board), "rb") as file:
        data = ELFFile(file).get_section_by_name(".data").data()
    print(f"{board}: {len(data)} bytes of .data, {len(data) - data.count(0)} of them not zero")
    assert len(data) < MOST_DATA


@on_f407
def test_the_stack_in_the_documents_matches_the_image(rig):
    """Each part by itself, so that it does not matter where an interrupt falls."""
    board, host = rig.board, rig.host
    board.watches_stacks = True
    host.connect()
    host.upload()
    host.arm()
    tones = [(slot, slot / 17, 0.06) for slot in range(16)]
    host.accept("Drive", drive(tones, 4000))
    host.live(0.005)
    host.accept("Drive", drive([], 2000))
    host.live(0.02)
    # The chord is so loud that it must be proven; a comb may not be.
    sixteen = {level: [((240 + 20 * n), level, -n * n / 32) for n in range(16)] for level in (0.1, 0.06)}
    for message, body in (("Chord", chord(12, sixteen[0.1], 4000)), ("Comb", comb(33, sixteen[0.06], 4000))):
        host.accept(message, body)
        host.live(0.005)
        host.accept("Drive", drive([], 2000))
        host.live(0.02)
    host.accept("Drive", drive(tones, 4000))
    host.live(0.005)
    # Sixteen lock-ins with the Hann window, and a capture.
    listen(host, 8, hann=True)
    host.capture(1, 1000)
    host.live(0.008)
    assert len(listened(host, 0).answers) == 16 and len(host.captured()[2]) == 1000
    # Then the lock-ins are a hold's, of a sensor that receives half of the drive; all levels fall.
    board.adc.at_pins = lambda: ((board.dac.output + 2048) // 2, 2048)
    host.hold([(slot, 8) for slot in range(16)], 20)
    host.live(0.03)
    progress, windows, held = host.held()
    assert progress == "on" and windows > 1 and all(correction < 0 for _, _, correction in held), held
    host.stage(40)
    host.accept("TableCommit")
    host.accept("DigestStart", DigestStart(host.status()["now"] + 4000, 1000))
    host.live(0.002)
    # A stop at a block's beginning begins in the block that waits.
    board.run_until(lambda: rig.played() % BLOCK == 0, 0.001, step=1e-6)
    assert host.accept("Stop") % BLOCK == 1
    host.live(0.1)
    host.accept("Disarm")
    host.live(0.1)
    host.accept("Store", patience=3)
    depths = dict(board.worst_depth)
    renderer = depths.pop(board.priorities[RENDERER_IRQ])
    seen = {"thread mode": board.thread_depth(), "renderer's interrupt": renderer, "other interrupts": sum(depths.values())}
    stated = {part: documented(part)[0] for part in seen}
    print(f"stack: {seen}, other interrupts by priority: {depths}")
    assert stated == pytest.approx(seen, abs=STACK_TOLERANCE)
    assert documented("worst stack") == [sum(stated.values())]


def test_every_test_that_the_safety_page_names_exists():
    named = set(re.findall(r"`(\w+_\w+_\w+)`", (ROOT / "firmware/SAFETY.md").read_text()))
    folders = ["tests/board/*.py", "tests/tests/**/*.rs", "firmware/*/src/**/*.rs", "host/tests/**/*.rs", "host/*/tests/**/*.rs"]
    sources = [source for folder in folders for source in ROOT.glob(folder)]
    text = "\n".join(source.read_text() for source in sources)
    assert len(named) > 15
    assert named == {name for name in named if re.search(rf"\b(?:def|fn) {name}\(", text)}


def test_the_rule_is_for_this_device_and_this_user_only():
    """R-65."""
    rules = [line for line in RULES.splitlines() if line and not line.startswith("#")]
    assert rules
    for rule in rules:
        assert re.search(r'ATTRS\{idVendor\}=="[0-9a-f]{4}"', rule) and re.search(r'ATTRS\{idProduct\}=="[0-9a-f]{4}"', rule)
        assert 'TAG+="uaccess"' in rule
        assert "MODE" not in rule and "0666" not in rule and "GROUP" not in rule
    assert 'ATTRS{idVendor}=="1209", ATTRS{idProduct}=="0001"' in rules[0]
    assert 'ENV{ID_MM_DEVICE_IGNORE}="1"' in rules[0]


def test_the_rule_comes_before_the_one_that_grants_what_it_asks_for():
    """systemd's 73-seat-late.rules acts on the tag; a later file has no effect."""
    (rule,) = (ROOT / "host/link").glob("*.rules")
    assert int(rule.name[:2]) < 73


def test_the_rule_names_the_identity_that_the_firmware_has():
    source = (ROOT / "firmware/stm32/src/usb_link.rs").read_text()
    vendor, product = (re.search(rf"const {name}: u16 = 0x(\w+);", source)[1] for name in ("VENDOR", "PRODUCT"))
    assert f'=="{vendor}"' in RULES and f'=="{product}"' in RULES
    assert 'manufacturer = Some("Slipline")' in source and 'ATTRS{manufacturer}=="Slipline"' in RULES


@pytest.mark.parametrize("board", BOARDS)
def test_every_board_has_its_command_in_the_documents(board):
    command = f"--no-default-features --features {board}"
    assert command in TEXT or board == "board-f4discovery"
