"""Messages between ranks: the only file that imports mpi4py."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, TypeVar, TypeVarTuple

import numpy as np
from mpi4py import MPI

from parsim.errors import InputError, WriteError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

Found = TypeVar("Found")
Given = TypeVarTuple("Given")


def waits(method: Callable[[Comm, *Given], Found]) -> Callable[[Comm, *Given], Found]:
    """Note while `method` of a Comm may wait for other ranks that it does: `parsim.launch.watch` looks at that."""

    @functools.wraps(method)
    def noted(self: Comm, *arguments: *Given) -> Found:
        self.calls, self.waiting = self.calls + 1, True
        try:
            return method(self, *arguments)
        finally:
            self.waiting = False

    return noted


class Comm:
    """The world communicator, with the ring of slabs: each rank has a left and a right neighbour, or none.

    calls: number of exchanges and sums so far; waiting: whether this rank is in one that may wait for others.
    """

    def __init__(self, ring: bool = False) -> None:
        self._mpi = MPI.COMM_WORLD
        self.rank, self.size = self._mpi.Get_rank(), self._mpi.Get_size()
        self.calls, self.waiting = 0, False
        self._sends: list[MPI.Request] = []  # under way
        self._sent: tuple[np.ndarray, ...] = ()  # what must stay until they have arrived
        last = self.size - 1
        self.left = self.rank - 1 if self.rank > 0 else (last if ring else None)
        self.right = self.rank + 1 if self.rank < last else (0 if ring else None)

    @property
    def library(self) -> str:
        """Version line of the MPI library."""
        return MPI.Get_library_version().split("\n")[0].strip("\0 ")

    def exchange(self, to_left: np.ndarray, to_right: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Send arrays of any length to both neighbours; returns (from left, from right), empty where there is none."""
        sizes = self.exchange_fixed(
            np.array([to_left.size]), np.array([to_right.size]), np.zeros(1, np.int64), np.zeros(1, np.int64)
        )
        received = [np.empty(int(size[0]), to_left.dtype) for size in sizes]
        return self.exchange_fixed(to_left, to_right, *received)

    def exchange_fixed(
        self, to_left: np.ndarray, to_right: np.ndarray, from_left: np.ndarray, from_right: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The same into given buffers whose lengths the ranks already know; returns the two buffers."""
        self.wait(self.start(to_left, to_right, from_left, from_right))
        return from_left, from_right

    @waits
    def start(
        self, to_left: np.ndarray, to_right: np.ndarray, from_left: np.ndarray, from_right: np.ndarray
    ) -> list[MPI.Request]:
        """Begin to exchange buffers of known lengths; returns what `wait` wants before the received ones may be read.

        What is sent belongs to this object from now on.
        """
        MPI.Request.Waitall(self._sends)
        receives, self._sends = [], []
        for peer, buffer, tag in ((self.left, from_left, 1), (self.right, from_right, 2)):
            if peer is not None:
                receives.append(self._mpi.Irecv(buffer, peer, tag=tag))
        for peer, buffer, tag in ((self.left, to_left, 2), (self.right, to_right, 1)):
            if peer is not None:
                self._sends.append(self._mpi.Isend(buffer, peer, tag=tag))
        self._sent = to_left, to_right
        return receives

    @waits
    def wait(self, receives: list[MPI.Request]) -> None:
        """End what `start` has begun, for the buffers received.

        Those sent are waited for at the next `start`: here that would mean to wait for a slower neighbour.
        """
        MPI.Request.Waitall(receives)

    @waits
    def deal(self, buffers: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Send the uint8 array buffers[r] to each rank r; returns what they have sent to this one, in their order."""
        received = [np.empty(0, np.uint8)] * self.size
        for step in range(self.size):  # one partner at a time: no rank is flooded, and lengths may exceed 2 GB in all
            to, source = (self.rank + step) % self.size, (self.rank - step) % self.size
            size = np.empty(1, np.int64)
            self._mpi.Sendrecv(np.array([buffers[to].size]), to, 5, size, source, 5)
            received[source] = np.empty(int(size[0]), np.uint8)
            self._mpi.Sendrecv(buffers[to], to, 6, received[source], source, 6)
        return received

    @waits
    def sum_integers(self, array: np.ndarray) -> np.ndarray:
        """All-reduced sum of an int64 array, exact in any order."""
        result = np.empty_like(array)
        self._mpi.Allreduce(array, result, MPI.SUM)
        return result

    @waits
    def max(self, values: Sequence[float] | np.ndarray) -> np.ndarray:
        """All-reduced element-wise maximum of floats."""
        result = np.empty(len(values))
        self._mpi.Allreduce(np.asarray(values, float), result, MPI.MAX)
        return result

    @waits
    def gather(self, array: np.ndarray, counts: Sequence[int] | np.ndarray) -> np.ndarray:
        """The floats that each rank gives, of any shape, one rank after another; counts (ranks,): how many of each."""
        result = np.empty(int(np.sum(counts)))
        self._mpi.Allgatherv(array, [result, np.asarray(counts, np.int64).tolist(), MPI.DOUBLE])
        return result

    @waits
    def share(self, item: Any) -> Any:
        """What rank 0 holds, on every rank."""
        return self._mpi.bcast(item)

    def first(self, work: Callable[..., Found], *arguments: Any) -> Found:
        """What `work` returns on rank 0, which alone does it, on every rank; so are its InputError and WriteError."""
        result = error = None
        if self.rank == 0:
            try:
                result = work(*arguments)
            except (InputError, WriteError) as refusal:
                error = refusal
        result, error = self.share((result, error))
        if error is not None:
            error.shared = True
            raise error
        return result

    def stream(self, array: np.ndarray) -> Iterator[np.ndarray]:
        """On rank 0 yields the array of each rank in turn, one at a time (bounded memory); nothing elsewhere."""
        if self.rank:
            self._hand_in(array)
            return
        yield array
        for source in range(1, self.size):
            yield self._collect(source, array.dtype)

    @waits
    def _hand_in(self, array):
        self._mpi.send(array.shape, 0, tag=3)
        self._mpi.Send(array, 0, tag=4)

    @waits
    def _collect(self, source, dtype):
        block = np.empty(self._mpi.recv(source=source, tag=3), dtype)
        self._mpi.Recv(block, source, tag=4)
        return block

    def abort(self, code: int) -> None:
        """End all ranks at once; may be called from any thread."""
        self._mpi.Abort(code)

    def ring(self) -> Ring | None:
        """A Ring of all ranks; None for a rank alone, or where the MPI library bears one thread only."""
        if self.size == 1 or MPI.Query_thread() < MPI.THREAD_MULTIPLE:
            return None
        return Ring(self._mpi)


class Ring:
    """Short messages from each rank to the next, and from the last to the first, for a thread of its own."""

    def __init__(self, mpi: MPI.Intracomm) -> None:
        self._mpi = mpi.Dup()
        self._sent: list[MPI.Request] = []
        rank, size = mpi.Get_rank(), mpi.Get_size()
        self.left, self._right = (rank - 1) % size, (rank + 1) % size

    def send(self, *numbers: int) -> None:
        """Tell the next rank some whole numbers, without waiting."""
        self._sent = [request for request in self._sent if not request.Test()]
        self._sent.append(self._mpi.Isend(np.array(numbers, np.int64), self._right))

    def receive(self, count: int = 2) -> tuple[int, ...] | None:
        """What the rank before has told last (count,), or None when there is no news."""
        news = None
        while self._mpi.Iprobe(self.left):
            news = np.empty(count, np.int64)
            self._mpi.Recv(news, self.left)
        return news if news is None else tuple(news.tolist())

    def close(self) -> None:
        """End it; called on all ranks together, when their threads have ended."""
        self._mpi.Barrier()
        self.receive()
        MPI.Request.Waitall(self._sent)
        self._mpi.Free()
