"""
A model of the driver's protocol, and a search over every order of its steps.

The driver and each process take one atomic step at a time: one read or write of a word, or one
system call. A real word counts its changes. The model keeps only what the driver compares: whether
the word has changed since the first look. A message is in its mailbox as soon as the send has
returned, as on the loopback interface.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

NEVER = 10**9
Operation = tuple[Any, ...]  # its kind and its operands
BUSY, IDLE, CLAIMED = 'BUSY', 'IDLE', 'CLAIMED'
UNBORN, ALIVE, ENDED = 'unborn', 'alive', 'ended'

RULES = (
    'look at the control sockets',
    'look at the in-flight set',
    'look at every word again',
    'register before IDLE',
    'deadline before IDLE',
    'IDLE before its report',
    'BUSY before deregister',
    'wait again if another process took the message',
    'ADOPT before fork',
    'read every ADOPT before letting go',
    'let go at the end, not when the socket closes',
    'one in-flight set per process',
)
"""The rules of the protocol. The search can break any of them."""

UNDER_LOCK = ('register', 'deadline', 'idle', 'report')
WAITING = (*UNDER_LOCK, 'asleep', 'busy')
"""The steps of a thread that waits, up to the one that marks its process BUSY again."""
LOOKING = ('deregister', 'look')
"""The steps after a wait. If its mailbox is empty, the thread waits again and computes nothing."""
STEPS_OF_WAIT = len(WAITING) + len(LOOKING)


class Process(NamedTuple):
    """A process with one thread and one helper thread, and what the driver knows of it."""

    life: str
    known: bool  # the driver has taken it on
    at: int = 0  # the next step of its program
    word: str = BUSY
    deadline: int = NEVER
    wake: bool = False  # the eventfd that its helper thread reads
    report: bool = False  # the eventfd that it writes when it is IDLE
    adopts: tuple[int, ...] = ()  # the children of unread ADOPTs
    closed: bool = False  # its socket
    unchanged: bool = False  # its word, since the first look


class State(NamedTuple):
    """One moment of a run."""

    processes: tuple[Process, ...]
    mail: tuple[int, ...]  # unread messages of each mailbox
    registered: frozenset[tuple[int, int]]  # process and mailbox
    driver: tuple[Any, ...]  # its next step
    now: int = 0

    def put(self, place: int, **changes: Any) -> State:
        """Return the state after one process has changed."""
        changed = list(self.processes)
        changed[place] = changed[place]._replace(**changes)
        return self._replace(processes=tuple(changed))

    def post(self, mailbox: int, number: int) -> State:
        """Return the state after messages have entered or left a mailbox."""
        mail = list(self.mail)
        mail[mailbox] += number
        return self._replace(mail=tuple(mail))

    def then(self, *driver: object) -> State:
        """Return the state with the driver's next step."""
        return self._replace(driver=driver)


class ViolationError(Exception):
    """The driver moved the time too early, or a run can never end."""


class Model:
    """
    The steps of one scenario.

    :param scripts: the operations of each process: ('compute',), ('send', mailbox),
        ('wait', mailbox, deadline), ('sleep', deadline), ('fork', process)
    :param begin: how many processes exist at the start; others are forked
    :param broken: the rules that this model breaks
    """

    def __init__(
        self, scripts: Sequence[Sequence[Operation]], begin: int, broken: Iterable[str] = ()
    ) -> None:
        self.broken = frozenset(broken)
        assert self.broken <= set(RULES)
        self.programs = [self._program(place, script) for place, script in enumerate(scripts)]
        if 'ADOPT before fork' in self.broken:
            self._let_children_announce_themselves()
        processes = [
            Process(ALIVE, known=True) if place < begin else Process(UNBORN, known=False)
            for place in range(len(scripts))
        ]
        mailboxes = 1 + max(
            (step[1] for program in self.programs for step in program if step[0] == 'send'),
            default=0,
        )
        self.first = State(tuple(processes), (0,) * mailboxes, frozenset(), ('listen',))

    def _program(self, place: int, script: Sequence[Operation]) -> list[Operation]:
        steps: list[Operation] = [('hello',)]
        for kind, *rest in script:
            if kind in ('wait', 'sleep'):
                mailbox = rest[0] if kind == 'wait' else None
                steps += self._wait(mailbox, rest[-1])
            elif kind == 'fork':
                steps += [('adopt', place, *rest), ('fork', *rest)]
            else:
                steps.append((kind, *rest))
        return [*steps, ('close',), ('end',)]

    def _let_children_announce_themselves(self) -> None:
        adopts = [step for program in self.programs for step in program if step[0] == 'adopt']
        for step in adopts:
            _, parent, child = step
            self.programs[parent].remove(step)
            self.programs[child].insert(0, step)

    def _wait(self, mailbox: int | None, deadline: int) -> list[Operation]:
        order = [*WAITING, *LOOKING]
        for rule, early, late in (
            ('register before IDLE', 'register', 'idle'),
            ('deadline before IDLE', 'deadline', 'idle'),
            ('IDLE before its report', 'idle', 'report'),
            ('BUSY before deregister', 'busy', 'deregister'),
        ):
            if rule in self.broken:
                order.remove(early)
                order.insert(order.index(late) + 1, early)
        if mailbox is None:
            order = [step for step in order if step not in ('register', 'deregister', 'look')]
        return [(step, mailbox, deadline) for step in order]

    def steps(self, state: State) -> Iterator[State]:
        """Yield every state that can follow."""
        for place, process in enumerate(state.processes):
            if process.life == ALIVE:
                yield from self._thread(state, place, process)
                if process.wake:
                    yield from self._helper(state, place, process)
        yield from self._drive(state)

    # -- a process --

    def _thread(self, state: State, place: int, process: Process) -> Iterator[State]:
        kind, *rest = self.programs[place][process.at]
        after = state.put(place, at=process.at + 1)
        key = (place if 'one in-flight set per process' not in self.broken else -1, *rest[:1])
        match kind:
            case 'hello' if not process.known:  # it waits for the driver's answer
                return
            case 'asleep' if rest[0] is None or not state.mail[rest[0]]:
                return
            case 'send':
                after = after.post(rest[0], 1)
            case 'adopt':
                adopts = state.processes[rest[0]].adopts
                after = after.put(rest[0], adopts=(*adopts, rest[1]))
            case 'fork':
                after = after.put(rest[0], life=ALIVE)
            case 'register':
                after = after._replace(registered=state.registered | {key})
            case 'deregister':
                after = after._replace(registered=state.registered - {key})
            case 'deadline':
                after = after.put(place, deadline=rest[1])
            case 'idle':
                after = after.put(place, word=IDLE, unchanged=False)
            case 'report':
                after = after.put(place, report=True)
            case 'busy' if process.word != BUSY:
                after = after.put(place, word=BUSY, unchanged=False)
            case 'look':
                after = self._look(state, place, process, *rest)
            case 'close':
                after = after.put(place, closed=True)
            case 'end':
                after = state.put(place, life=ENDED)
        yield after

    def _look(
        self, state: State, place: int, process: Process, mailbox: int, deadline: int
    ) -> State:
        """Read a message, or wait again."""
        after = state.put(place, at=process.at + 1)
        if state.mail[mailbox]:
            return after.post(mailbox, -1)
        if state.now >= deadline:
            return after
        if 'wait again if another process took the message' in self.broken:
            raise ViolationError(f'a wait until {deadline} ends at {state.now} with nothing')
        return state.put(place, at=process.at - STEPS_OF_WAIT + 1)

    def _helper(self, state: State, place: int, process: Process) -> Iterator[State]:
        """Serve a claim: wake the thread if it waits and is due."""
        kind, *rest = self.programs[place][process.at]
        after = state.put(place, wake=False)
        if kind in UNDER_LOCK:
            return
        if kind not in WAITING or process.word == BUSY:
            yield after
        elif state.now >= rest[1]:
            yield after.put(place, at=process.at + 1, word=BUSY, unchanged=False)
        else:
            yield after.put(place, word=IDLE, unchanged=False, report=True)

    # -- the driver --

    def _drive(self, state: State) -> Iterator[State]:
        phase, *rest = state.driver
        known = [place for place, process in enumerate(state.processes) if process.known]
        match phase:
            case _ if not known:  # the driver ends
                return
            case 'listen':
                if self._has_heard(state):
                    yield self._handle(state).then('look', 0)
            case 'look' | 'look again' if rest[0] < len(known):
                yield self._look_at(state, phase, known, rest[0])
            case 'look':
                yield state.then('control')
            case 'control':
                if 'look at the control sockets' not in self.broken and self._has_heard(state):
                    yield self._handle(state).then('look', 0)
                else:
                    yield state.then('in flight')
            case 'in flight':
                seen = any(state.mail[mailbox] for _, mailbox in state.registered)
                if seen and 'look at the in-flight set' not in self.broken:
                    yield state.then('listen')
                elif 'look at every word again' in self.broken:
                    yield state.then('choose')
                else:
                    yield state.then('look again', 0)
            case 'look again':
                yield state.then('choose')
            case 'choose':
                first = min(known, key=lambda place: state.processes[place].deadline)
                deadline = state.processes[first].deadline
                yield state.then(
                    *(['listen'] if deadline == NEVER else ['claim', first, deadline])
                )
            case 'claim':
                yield self._claim(state, *rest)
            case 'time':
                self._check(state, rest[1])
                yield state._replace(now=max(state.now, rest[1])).then('wake', rest[0])
            case 'wake':
                yield state.put(rest[0], wake=True).then('look', 0)

    def _look_at(self, state: State, phase: str, known: list[int], index: int) -> State:
        process = state.processes[known[index]]
        if phase == 'look' and process.word == IDLE:
            return state.put(known[index], unchanged=True).then(phase, index + 1)
        if phase == 'look again' and process.unchanged:
            return state.then(phase, index + 1)
        return state.then('listen')

    def _claim(self, state: State, first: int, deadline: int) -> State:
        if not state.processes[first].unchanged:
            return state.then('listen')
        claimed = state.put(first, word=CLAIMED, unchanged=False)
        return claimed.then('time', first, deadline)

    def _is_over(self, process: Process) -> bool:
        if 'let go at the end, not when the socket closes' in self.broken:
            return process.closed
        return process.life == ENDED

    def _has_heard(self, state: State) -> bool:
        return any(
            process.known and (process.report or process.adopts or self._is_over(process))
            for process in state.processes
        )

    def _handle(self, state: State) -> State:
        """Handle one event per descriptor; the end of a process comes after its socket."""
        for place in [i for i, process in enumerate(state.processes) if process.known]:
            process = state.processes[place]
            is_over = self._is_over(process)
            drains = is_over and 'read every ADOPT before letting go' not in self.broken
            for child in process.adopts if drains else process.adopts[:1]:
                state = state.put(child, known=True)
            left = () if is_over else process.adopts[1:]
            state = state.put(place, report=False, adopts=left, known=not is_over)
        return state

    # -- what must hold --

    def _check(self, state: State, moved_to: int) -> None:
        """Raise a violation if the time must not move from now to a later time."""
        if moved_to <= state.now:
            return
        for place, process in enumerate(state.processes):
            kind, *rest = self.programs[place][process.at]
            if process.adopts:
                raise ViolationError(f'process {place} has announced a child')
            if process.life != ALIVE:
                continue
            if kind not in (*WAITING, *LOOKING):
                raise ViolationError(f'process {place} computes ({kind})')
            if rest[0] is not None and state.mail[rest[0]]:
                raise ViolationError(f'process {place} has an unread message')
            if rest[1] < moved_to:
                raise ViolationError(f'process {place} was due before {moved_to}')

    def has_finished(self, state: State) -> bool:
        """Return whether every process has ended, or waits forever."""
        for place, process in enumerate(state.processes):
            kind, *rest = self.programs[place][process.at]
            waits_forever = kind == 'asleep' and rest[1] == NEVER
            done = not process.known and not process.adopts and process.life != ALIVE
            if not done and not waits_forever:
                return False
        return True


def explore(model: Model) -> int:
    """
    Visit every state that a model can reach.

    :returns: the number of states
    :raises ViolationError: if the time moves too early, a run stops before its end, or a state
        cannot lead to an end
    """
    before: dict[State, list[State]] = {model.first: []}
    ends: list[State] = []
    queue = deque([model.first])
    while queue:
        state = queue.popleft()
        stuck = True
        for following in model.steps(state):
            stuck = False
            if following not in before:
                before[following] = []
                queue.append(following)
            before[following].append(state)
        if stuck:
            if not model.has_finished(state):
                raise ViolationError(f'no step is possible: {state}')
            ends.append(state)
    reached = set(ends)
    while ends:
        for earlier in before[ends.pop()]:
            if earlier not in reached:
                reached.add(earlier)
                ends.append(earlier)
    if len(reached) < len(before):
        raise ViolationError('a run can loop forever')
    return len(before)
