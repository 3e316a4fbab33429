"""The stack is large enough whatever happens: a bound by the image's call graph, which no run can pass."""
import re

import pytest

from boards import BOARDS, DAC_IRQ, RENDERER_IRQ, TIME_IRQ
from call_graph import INDIRECT, CallGraph
from images import firmware
from test_documents import STACK_TOLERANCE, documented

# An exception's frame with the registers of the floating-point unit, and a word to align it (ARMv7-M B1.5.7).
FRAME = 26 * 4 + 4
NMI, FIRST_IRQ = 2, 16
EXECUTOR = r"executor.*(Executor.*poll|on_interrupt)"


def task(graph, is_renderer):
    """What an executor may call: in its interrupt the renderer's task, in thread mode the others."""
    polls = [address for address, function in graph.functions.items() if re.search("TaskStorage.*poll", function.name)]
    above = {address for address in polls if reaches(graph, address, "listener.*Listener")}
    assert len(above) == 1 < len(polls)
    chosen = above if is_renderer else set(polls) - above
    return {EXECUTOR: "|".join(re.escape(graph.functions[address].name) for address in chosen), **INDIRECT}


def reaches(graph, root, name):
    """Whether a function calls one of a name, or one that does."""
    seen, rest = set(), [root]
    while rest:
        address = rest.pop()
        if address not in seen:
            seen.add(address)
            rest += graph.functions[address].calls
    return any(re.search(name, graph.functions[address].name) for address in seen)


@pytest.mark.parametrize("board", BOARDS, ids=lambda board: board.name)
def test_no_call_and_no_interrupt_can_need_more_stack_than_the_board_has(board):
    graph = CallGraph(firmware(board.feature))

    def needs(vector, indirect=INDIRECT):
        return graph.deepest(graph.handler(vector), indirect)[0] + FRAME

    thread, way = graph.deepest(graph.by_name["main"], task(graph, is_renderer=False))
    renderer = needs(FIRST_IRQ + RENDERER_IRQ, task(graph, is_renderer=True))
    # One of each priority, and the NMI above them.
    levels = [(board.dma_irq, DAC_IRQ, board.chip.SUPPLY_IRQ), board.urgent_link_irqs, board.waking_link_irqs, (TIME_IRQ,)]
    others = sum(max(needs(FIRST_IRQ + irq) for irq in level) for level in levels if level) + needs(NMI)
    seen, there_is = [thread, renderer, others, thread + renderer + others], graph.stack
    print(f"{board.name}: {seen} of {there_is} bytes; thread mode by {[name[-60:] for name in way]}")
    assert seen[-1] <= there_is == board.chip.STACK[1]
    stated = documented(f"stack of {board.feature}")
    assert stated[:-1] == pytest.approx(seen, abs=STACK_TOLERANCE) and stated[-1] == there_is
