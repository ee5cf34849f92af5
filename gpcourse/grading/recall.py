"""Judging a class: what was found out about one submission is not found out again for the next.

A check is a function of its seed and of the answers that it gets. So what it asks first, what it asks after
these answers, and how it ends can be remembered under a digest of all answers so far, byte by byte as they
were received. The questions that do not depend on any answer are put to the student's function in one go.

No verdict depends on it: what is not remembered is found by running the check itself, and an answer that
differs in one byte is another answer.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from hashlib import blake2b
from typing import Any

from gpcourse.errors import WireError, WorkerError
from gpcourse.exercises.exercise import Check, Exercise
from gpcourse.exercises.feedback import handed_out
from gpcourse.exercises.judging import (
    IMPATIENT,
    Asked,
    CheckResult,
    Ours,
    Question,
    Verdict,
    conclude,
    run_check,
)
from gpcourse.grading.plan import planned
from gpcourse.sandbox.call import Answer
from gpcourse.sandbox.proxy import Reply, Worker, question

#: Bytes that a memory may hold, about. A chapter's questions and right answers take 2 to 10 MB.
CAPACITY = 96 * 2**20


@dataclass(frozen=True)
class Step:
    """What a check asks next; where `refusals` is True it goes on if the call raised an exception."""

    questions: tuple[bytes, ...]
    refusals: tuple[bool, ...]


class Memory:
    """A table that forgets what was not used for longest when it holds more than `capacity` bytes."""

    def __init__(self, capacity: int = CAPACITY) -> None:
        self.capacity = capacity
        self.size = 0
        self._entries: OrderedDict[Any, tuple[Any, int]] = OrderedDict()

    def get(self, key: Any) -> Any:
        """Return what is remembered under a key, or None."""
        if key not in self._entries:
            return None
        self._entries.move_to_end(key)
        return self._entries[key][0]

    def put(self, key: Any, value: Any, size: int) -> None:
        """Remember `value`, which takes about `size` bytes."""
        self.size += size + 500 - self._entries.pop(key, (None, 0))[1]  # 500: the key and the table itself
        self._entries[key] = (value, size + 500)
        while self.size > self.capacity:
            _, (_, freed) = self._entries.popitem(last=False)
            self.size -= freed

    def __len__(self) -> int:
        return len(self._entries)


class Recall:
    """Judges exercises as `judging.judge` does, with the same verdicts, for one seed."""

    def __init__(self, seed: int, capacity: int = CAPACITY) -> None:
        self.seed = seed
        self.memory = Memory(capacity)

    def judge(self, exercise: Exercise, worker: Worker) -> Verdict:
        """Run every check of `exercise` on a worker's function of that name, and say how it went."""
        results: list[CheckResult] = []
        ends: list[bytes] = []
        limit, size = exercise.time_limit, 0
        for check in exercise.checks:
            talk = Talk(self, exercise, check, worker, limit)
            result = talk.result()
            if result.outcome == "not attempted":
                return Verdict(exercise, "not attempted")
            if any(question.answer.status == "timeout" for question in result.questions):
                limit = min(limit, IMPATIENT)
            results.append(result)
            ends.append(talk.key)
            size += talk.size
        return self._conclude(exercise, results, ends, size)

    def feedback(self, verdict: Verdict) -> str:
        """Write the feedback that is handed out, once for all who answered the same."""
        # Under its place in memory, which is another verdict's once this one is forgotten.
        known, html = self.memory.get(id(verdict)) or (None, "")
        if known is not verdict:
            return handed_out(verdict)
        if not html:
            html = handed_out(verdict)
            self.memory.put(id(verdict), (verdict, html), len(html))
        return str(html)

    def _conclude(
        self, exercise: Exercise, results: list[CheckResult], ends: list[bytes], size: int
    ) -> Verdict:
        key = (exercise.name, *ends)
        known: Verdict | None = self.memory.get(key) if all(ends) else None
        if known is not None:
            return known
        verdict = conclude(exercise, results, Recollected(exercise, self))
        if all(ends) and verdict.outcome != "grader fault":
            self.memory.put(key, verdict, size)
            self.memory.put(id(verdict), (verdict, ""), 0)
        return verdict


class Talk:
    """One check of one submission: the replies so far, and the key that they lead to.

    The key is empty once a process ended without an answer, which may go otherwise next time.
    """

    def __init__(
        self, recall: Recall, exercise: Exercise, check: Check, worker: Worker, limit: float
    ) -> None:
        self.memory, self.seed = recall.memory, recall.seed
        self.exercise, self.check, self.worker, self.limit = exercise, check, worker, limit
        self.start = blake2b(f"{exercise.name}: {check.claim}".encode(), digest_size=16).digest()
        self.key = self.start
        self.questions: list[bytes] = []
        self.replies: list[Reply] = []

    @property
    def size(self) -> int:
        """About how many bytes the questions and answers take."""
        return sum(map(len, self.questions)) + sum(len(reply.frame) for reply in self.replies)

    def result(self) -> CheckResult:
        """Ask what is known to be asked, until the result is known; run the check where it is not."""
        if self.memory.get(self.start) is None:
            step = Step(*planned(self.exercise, self.check, self.seed))
            self.memory.put(self.start, step, sum(map(len, step.questions)))
        while self.key:
            known = self.memory.get(self.key)
            if isinstance(known, CheckResult):
                return known
            if known is None or not known.questions:
                break
            try:
                self._ask(known)
            except WorkerError:  # raised again where the check asks: a fault of ours
                break
        return self._run()

    def _ask(self, step: Step) -> None:
        replies = self.worker.ask_all(self.exercise.name, step.questions, step.refusals, self.limit)
        self.questions += step.questions[: len(replies)]
        self.replies += replies
        for reply in replies:
            self.key = self._after(self.key, reply)

    @staticmethod
    def _after(key: bytes, reply: Reply) -> bytes:
        return blake2b(key + reply.digest, digest_size=16).digest() if key and reply.digest else b""

    def _run(self) -> CheckResult:
        """Run the check: what was asked already is not asked again."""
        used, self.key = 0, self.start

        def ask(arguments: tuple[Any, ...], options: dict[str, Any], limit: float) -> Answer:
            nonlocal used
            frame = question(arguments, options)
            if self.questions[used : used + 1] != [frame]:
                del self.questions[used:], self.replies[used:]
                step = Step((frame,), (True,))
                if used and self.key:
                    self.memory.put(self.key, step, len(frame))
                self.questions.append(frame)
                self.replies += self.worker.ask_all(self.exercise.name, *_fields(step), limit)
            reply = self.replies[used]
            used += 1
            self.key = self._after(self.key, reply)
            return reply.answer

        result = run_check(self.check, Asked(self.exercise, ask, self.limit), self.seed)
        if used and self.key and result.outcome != "grader fault":
            self.memory.put(self.key, result, 2 * self.size)
        return result


def _fields(step: Step) -> tuple[tuple[bytes, ...], tuple[bool, ...]]:
    return step.questions, step.refusals


class Recollected(Ours):
    """What the reference and the mistakes answer, each question asked once."""

    def __init__(self, exercise: Exercise, recall: Recall) -> None:
        super().__init__(exercise, recall.seed)
        self.memory = recall.memory

    def answer(self, m: int, question: Question) -> Answer:
        """Return what solution `m` answers to a question."""
        try:
            frame = _frame(question)
        except WireError:
            return super().answer(m, question)
        key = (self.exercise.name, m, blake2b(frame, digest_size=16).digest())
        known: Answer | None = self.memory.get(key)
        if known is None:
            known = super().answer(m, question)
            self.memory.put(key, known, len(frame))
        return known

    def passes(self, m: int, check: Check) -> bool:
        """Tell whether solution `m` passes a check."""
        key = (self.exercise.name, m, check.claim)
        known: bool | None = self.memory.get(key)
        if known is None:
            known = super().passes(m, check)
            self.memory.put(key, known, 0)
        return known


def _frame(asked: Question) -> bytes:
    return question(asked.arguments, asked.options)
