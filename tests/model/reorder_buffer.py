# SPDX-License-Identifier: Apache-2.0
"""The unit reorder_buffer, after docs/reorder_buffer.md."""
from collections import deque
from collections.abc import Iterable, Iterator
from typing import Any

from numeric import clog2, hilbert_index
from plan import Plan

Packet = dict[str, Any]


def bin_of(plan: Plan, position: list[int]) -> int:
    """docs/reorder_buffer.md, "What it computes", Bin."""
    bin_bits = clog2(plan["reorder.bins"])
    cell_bits: int = plan["reorder.cell_bits"]
    below: int = plan["photon.position_bits"] - cell_bits
    x, y, z = (coordinate >> below for coordinate in position)
    if plan["reorder.key"] == "hilbert":
        return hilbert_index(x, y, z, cell_bits) >> 3 * cell_bits - bin_bits
    cell = (z << cell_bits | y) << cell_bits | x
    return (cell * 2654435769 & 0xFFFFFFFF) >> 32 - bin_bits


class ReorderBuffer:
    """Packets held, and the state of the drain. docs/reorder_buffer.md, "What it computes", Order and Flush."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.reset()

    def reset(self) -> None:
        self.bins: list[deque[Packet]] = [deque() for _ in range(self.plan["reorder.bins"])]
        self.held = 0
        self.current = 0  # sweep: the current bin; fullest: the bin of the last choice
        self.fixed = 0    # fullest: how many of that choice have not left yet

    def accept(self, packet: Packet) -> Iterator[Packet]:
        """Takes a packet and gives what leaves because of it."""
        if self.plan["reorder.key"] == "none":
            yield packet
        elif packet["flush"]:
            while self.held:
                yield self.leave()
            yield packet
            self.reset()
        else:
            self.bins[bin_of(self.plan, packet["position"])].append(packet)
            self.held += 1
            if self.held == self.plan["reorder.packets"]:
                yield self.leave()

    def leave(self) -> Packet:
        """The packet that leaves a buffer that holds some."""
        if self.plan["reorder.drain"] == "sweep":
            while not self.bins[self.current]:
                self.current = (self.current + 1) % len(self.bins)
        else:
            if self.fixed == 0:
                lengths = [len(queue) for queue in self.bins]
                self.fixed = max(lengths)
                self.current = lengths.index(self.fixed)
            self.fixed -= 1
        self.held -= 1
        return self.bins[self.current].popleft()


def run(plan: Plan, packets: Iterable[Packet]) -> list[Packet]:
    """Packets out, in order; a packet leaves as it came."""
    buffer = ReorderBuffer(plan)
    return [out for packet in packets for out in buffer.accept(packet)]
