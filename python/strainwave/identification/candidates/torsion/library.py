"""Parts of a gear whose torque is linear in positive weights: the best of many is found by convex problems, without a start."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear
from strainwave.equality import ComparedByFields

Array = NDArray[np.float64]
MAX_ROUNDS = 4  # of choosing spring and hysteresis in turn; no loop tried took more than three


@dataclass(frozen=True)
class Choice:
    """A part with all numbers chosen but its weights.

    Attributes:
        columns: of the library's torques, those of its weights
        put: returns the gear with this part, from its weights
        group: choices of one group lead to the same minimum; answers are of several groups
    """

    columns: tuple[int, ...]
    put: Callable[[Gear, Array], Gear]
    group: float = 0.0


@dataclass(frozen=True, eq=False)
class Library(ComparedByFields):
    """Torques that one kind of part can add.

    Attributes:
        torques: of unit weights along the loop [N.m], shape (n, m)
        choices: of which a gear has one
    """

    torques: Array
    choices: tuple[Choice, ...]

    @classmethod
    def of(cls, torques: Sequence[Array], choices: Sequence[Choice]) -> Library:
        return cls(np.column_stack(torques), tuple(choices))


@dataclass(frozen=True, eq=False)
class Answer(ComparedByFields):
    """The best choice of each library.

    Attributes:
        choices: one of each library
        weights: of each, and of the columns that always take part
        error: root of the sum of the squared residuals [N.m]
    """

    choices: tuple[Choice, ...]
    weights: tuple[Array, ...]
    error: float

    def put(self, gear: Gear) -> Gear:
        """Return the gear with all parts."""
        for choice, weights in zip(self.choices, self.weights, strict=False):
            gear = choice.put(gear, weights)
        return gear


def solve(torque: Array, libraries: Sequence[Library], always: Array, most: int = 1) -> list[Answer]:
    """Return the choices of each library that explain a torque best, with positive weights.

    For given choices the weights are a convex problem, non-negative least squares (LawsonHanson1974). The triangle of one QR
    decomposition of all columns replaces the columns. The libraries are tried in turn until nothing improves.

    Args:
        torque: to explain [N.m], shape (n,)
        libraries: kinds of parts; one choice of each is taken
        always: columns that take part in any choice, shape (n, k)
        most: largest count of answers

    Returns:
        answers, best first; their choices of the first library that has several groups are of different ones

    Raises:
        ValueError: no choice has an answer

    >>> x = np.linspace(-1.0, 1.0, 9)
    >>> powers = Library.of([x, x**3, x**5], [Choice((0, 1), lambda gear, w: gear), Choice((0, 2), lambda gear, w: gear)])
    >>> found = solve(2.0 * x + 3.0 * x**5, [powers], np.empty((9, 0)))[0]
    >>> found.choices[0].columns, found.weights[0].round(12)
    ((0, 2), array([2., 3.]))
    """
    matrix = np.column_stack([*(library.torques for library in libraries), always])
    size = np.linalg.norm(matrix, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    triangle = np.asarray(np.linalg.qr(np.column_stack((matrix / size, torque)), mode="r"), float)
    firsts = np.cumsum([0, *(library.torques.shape[1] for library in libraries)])
    constant = [*range(firsts[-1], matrix.shape[1])]

    answers: dict[tuple[int, ...], Answer] = {}

    def tries(numbers: tuple[int, ...]) -> None:
        choices = [library.choices[number] for library, number in zip(libraries, numbers, strict=True)]
        places = [
            [first + column for column in choice.columns] for first, choice in zip(firsts[:-1].tolist(), choices, strict=True)
        ]
        order = [*chain(*places), *constant]
        found = _positive(triangle[:, order], triangle[:, -1])
        if found is not None:
            ends = np.cumsum([len(each) for each in places])
            answers[numbers] = Answer(tuple(choices), tuple(np.split(found[0] / size[order], ends)), found[1])

    chosen = (0,) * len(libraries)
    for _ in range(MAX_ROUNDS):
        before = len(answers)
        for place, library in enumerate(libraries):
            for number in range(len(library.choices)):
                numbers = (*chosen[:place], number, *chosen[place + 1 :])
                if numbers not in answers:
                    tries(numbers)
            chosen = min(answers, key=lambda each: answers[each].error, default=chosen)
        if len(answers) == before:
            break
    if not answers:
        raise ValueError("no spring and hysteresis fits this loop; see whether the units of twist and torque are right")
    parted = next((place for place, each in enumerate(libraries) if len({choice.group for choice in each.choices}) > 1), 0)
    of_groups: dict[float, Answer] = {}
    for answer in sorted(answers.values(), key=lambda answer: answer.error):
        of_groups.setdefault(answer.choices[parted].group, answer)
    return [*of_groups.values()][:most]


def _positive(matrix: Array, torque: Array) -> tuple[Array, float] | None:
    """Return non-negative weights and their error; None if the active set cycles, as other choices remain."""
    from scipy.optimize import nnls

    try:
        weights, error = nnls(matrix, torque)
    except RuntimeError:
        return None
    return weights, float(error)
