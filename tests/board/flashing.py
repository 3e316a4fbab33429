"""A tool that flashes a board: it reads a released file, erases the sectors of what the file holds, and programs that.

So do dfu-util (`dfuse_dnload_element`: each element's pages, or those of a raw file from its address on), probe-rs, OpenOCD
and STM32CubeProgrammer. st-flash joins the records of a `.hex` over their gaps first (`stlink_parse_ihex`): `is_joined`.
"""
import struct
import zlib

VENDOR, PRODUCT = 0x0483, 0xDF11


def read_dfuse(file):
    """The elements of a DfuSe file (UM0391) for the chip's flash (alternate setting 0), in the order in which they are written."""
    body, suffix = file[:-16], struct.unpack("<4H3sBI", file[-16:])
    assert suffix[1:] == (PRODUCT, VENDOR, 0x011A, b"UFD", 16, zlib.crc32(file[:-4]) ^ 0xFFFFFFFF)
    assert struct.unpack_from("<5sBIB", body) == (b"DfuSe", 1, len(body), 1), "one target"
    signature, setting, is_named, _, size, count = struct.unpack_from("<6sBI255sII", body, 11)
    assert (signature, setting, is_named, size) == (b"Target", 0, 0, len(body) - 11 - 274)
    parts, at = [], 11 + 274
    for _ in range(count):
        address, length = struct.unpack_from("<II", body, at)
        parts.append((address, body[at + 8 : at + 8 + length]))
        at += 8 + length
    assert at == len(body)
    return parts


def read_hex(file):
    """The data records of an Intel HEX file."""
    parts, upper, is_over = [], 0, False
    for line in file.decode().split():
        record = bytes.fromhex(line.removeprefix(":"))
        assert not is_over and line[0] == ":" and sum(record) & 0xFF == 0 and len(record) == record[0] + 5
        offset, kind, content = int.from_bytes(record[1:3], "big"), record[3], record[4:-1]
        assert kind in (0, 1, 4)
        if kind == 4:
            upper = int.from_bytes(content, "big") << 16
        elif kind == 0:
            parts.append((upper + offset, content))
        is_over = kind == 1
    assert is_over
    return parts


def read(name, file, start):
    """What a file holds: addresses and contents, in the order in which they are written."""
    if name.endswith(".dfu"):
        return read_dfuse(file)
    return read_hex(file) if name.endswith(".hex") else [(start, file)]


def joined(parts):
    first, end = min(at for at, _ in parts), max(at + len(content) for at, content in parts)
    whole = bytearray(b"\xff" * (end - first))
    for at, content in parts:
        whole[at - first : at - first + len(content)] = content
    return [(first, bytes(whole))]


def flash(board, name, file, is_joined=False):
    """Flashes a board by a file and switches it on."""
    parts = read(name, file, board.FLASH_START)
    parts = joined(parts) if is_joined else parts
    # No sector is smaller than 1 KiB, nor are two of them in one.
    sectors = {
        board.flash.sector_at(at) for address, content in parts
        for at in (*range(address, address + len(content), 1024), address + len(content) - 1)
    }  # fmt: skip
    for start, size in sectors:
        board.cpu.mem_write(start, b"\xff" * size)
    for address, content in parts:
        board.cpu.mem_write(address, content)
    board.cpu.ctl_flush_tb()
    board.reset("power")


def make_factory_new(board):
    board.cpu.mem_write(board.FLASH_START, b"\xff" * board.MEMORIES[board.FLASH_START])
