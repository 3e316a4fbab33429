"""A night in pieces runs every test, once."""
from types import SimpleNamespace

import pytest

from pieces import LONG, USUAL, piece


def items():
    """A hundred tests of five modules on three boards, some of them long."""
    return [
        SimpleNamespace(
            number=number, module=SimpleNamespace(__name__=f"module {number % 5}"),
            originalname=next(iter(LONG)) if number % 17 == 0 else "test", callspec=SimpleNamespace(params={"facts": number % 3}),
        )
        for number in range(100)
    ]  # fmt: skip


@pytest.mark.parametrize("pieces", [1, 2, 7, 12])
def test_every_test_is_in_one_piece_and_no_piece_is_much_longer_than_the_others(pieces):
    tests = items()
    parts = [piece(tests, f"{count}/{pieces}") for count in range(1, pieces + 1)]
    assert sorted(test.number for part in parts for test in part) == list(range(100))
    takes = [sum(LONG.get(test.originalname, USUAL) for test in part) for part in parts]
    longest = max(LONG.values())
    assert max(takes) <= sum(takes) / pieces + longest


def test_the_tests_on_a_board_stay_together():
    boards = [test.callspec.params["facts"] for count in (1, 2) for test in piece(items(), f"{count}/2")]
    assert boards == sorted(boards)


@pytest.mark.parametrize("number", ["0/2", "3/2"])
def test_a_missing_piece_is_refused(number):
    with pytest.raises(pytest.UsageError):
        piece(items(), number)
