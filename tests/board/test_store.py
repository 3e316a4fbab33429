"""The table that is stored survives: the power, and a cut of it at any moment (R-35)."""
import random

import pytest

from copies import on_copy
from core.processor import PowerCut
HEADER_BYTES = 32
# What a cut in the middle of a word leaves of it: the bits that it has not got yet, of all that fall.
TORN = {"half": 0xA5A5A5A5, "the other half": 0x5A5A5A5A, "hardly": 0xFFFFFFFF, "nearly whole": 0}


@pytest.mark.every_image
def test_the_table_survives_the_power_and_storing_it_is_no_underrun(rig):
    rig.host.connect()
    crc = rig.keep(33)
    status = rig.host.status()
    assert (status["underruns"], status["faults"], rig.board.dac.underruns) == (0, set(), 0)
    rig.board.reset("power")
    identity = rig.host.connect()
    assert identity["stored"] == "loaded"
    assert rig.stored_crc() == crc
    assert rig.host.maintenance() == (1, 20_000, True)


@pytest.mark.every_image
def test_a_board_without_its_brown_out_level_says_so(rig):
    rig.board.flash.set_brown_out_bits(rig.facts.delivered)
    rig.host.connect()
    assert rig.host.maintenance() == (0, 20_000, False)


# The application's matter, not the chip's: the other images have it at night.
def test_after_sixteen_stores_in_a_row_the_flash_is_spared(rig):
    """R-89: what is stored and forgotten in turn is erased each time."""
    host = rig.host
    host.connect()
    host.upload(33)
    host.live(0.002)
    assert host.wear() == (0, 20_000, 16)
    for message in ("Store", "Forget") * 8:
        host.accept(message, patience=rig.facts.store_seconds)
    assert host.wear() == (0, 20_000, 0)
    reply = host.exchange("Store", patience=rig.facts.store_seconds)
    assert reply.refuses("StoresSpent") and host.maintenance()[0] == 16
    # The seconds of a minute that are left; the erasures took some.
    assert 60 - 16 * rig.facts.store_seconds < reply.value.wait_s <= 60
    # What is kept already costs nothing.
    assert host.exchange("Forget").name == "Unchanged"


def operation_at(facts, words):
    """The flash's operation during which the power fails: the first erasure, or the one after `words` written words of 4 bytes."""
    return facts.erasures - 1 + -(-4 * words // facts.word_bytes) if words else 0


def cut(rig, operation, missing=TORN["half"]):
    """Stores, and cuts the power in the middle of one of the flash's operations, or before it if nothing is `missing`;
    then switches on again; returns what that finds."""
    flash = rig.board.flash
    flash.cut_at, flash.is_cut_clean = flash.operations + operation, missing is None
    flash.missing = missing or 0
    with pytest.raises(PowerCut):
        rig.host.accept("Store", patience=rig.facts.store_seconds)
    rig.board.reset("power")
    rig.host.forget()
    return rig.host.connect()["stored"]


def stores_again(rig, erasures=None):
    # Nothing has sounded since the start, so there is nothing to wait for but the commit.
    again = rig.host.upload(35)
    rig.host.live(0.002)
    rig.host.accept("Store", patience=rig.facts.store_seconds)
    assert erasures is None or rig.host.maintenance()[0] == erasures
    rig.board.reset("power")
    assert rig.host.connect()["stored"] == "loaded"
    assert rig.stored_crc() == again


@pytest.mark.parametrize("words", [0, 1, 2, 9, 40, *(pytest.param(words, marks=pytest.mark.every_image) for words in (75, 82))])
def test_a_power_cut_while_storing_leaves_the_old_or_the_new_table(kept, words):
    """R-36, too: the cut comes before the first erasure is over, between words, and in the last words; what it tears is half
    erased or half written, and cannot be corrected where the flash has error correction. The last eight of the 88 words are
    the record's header, which the next start reads: the G474 gets its NMI and the H743 its bus fault then."""
    stored = cut(kept, operation_at(kept.facts, words))
    # Half an erasure of what was blank leaves no trace, where no word can become unreadable.
    is_reported = words > 0 or kept.facts.word_bytes > 4
    assert stored == ("fell back" if is_reported else "loaded")
    assert kept.host.status()["faults"] == ({"store fell back"} if is_reported else set())
    # A table limits nothing, so a host alone may go on with the older one.
    kept.host.accept("ClearFaults")
    assert kept.host.status()["faults"] == set()
    assert kept.stored_crc() == kept.old
    stores_again(kept, erasures=2 + is_reported)


def operations(rig):
    """How many a store takes."""
    before = rig.board.flash.operations
    rig.host.accept("Store", patience=rig.facts.store_seconds)
    return rig.board.flash.operations - before


@pytest.mark.nightly
@pytest.mark.parametrize("missing", [None, *TORN.values()], ids=["clean", *TORN])
def test_a_power_cut_at_any_operation_leaves_the_old_or_the_new_table(kept, missing):
    """The new one only if the cut is in the header, which is written last, and leaves all its bits."""
    total = on_copy(kept, operations)
    headers = HEADER_BYTES // kept.facts.word_bytes

    def case(rig):
        assert cut(rig, operation, missing) in ("loaded", "fell back")
        stored = rig.stored_crc()
        assert stored in (rig.old, rig.new)
        stores_again(rig)
        return stored == rig.new

    for operation in range(total):
        assert not on_copy(kept, case) or operation >= total - headers, f"the new table after operation {operation}"


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(4))
def test_the_old_table_survives_cut_after_cut(kept, seed):
    """Each next try begins with what the last one has torn."""
    chance, total = random.Random(seed), on_copy(kept, operations)
    headers = HEADER_BYTES // kept.facts.word_bytes
    for _ in range(6):
        cut(kept, chance.randrange(total - headers), chance.choice([None, *TORN.values()]))
        assert kept.stored_crc() == kept.old
        kept.upload_to_keep(34)
    stores_again(kept)
