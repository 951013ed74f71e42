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
ROUNDS = 4  # in which spring and hysteresis are chosen in turn; none tried took more than three


@dataclass(frozen=True)
class Choice:
    """A part with all numbers chosen but its weights.

    Attributes:
        columns: of the library's torques, those of its weights
        put: the gear with this part, from its weights
        group: choices of one group lead to the same minimum; starts are sought in several
    """

    columns: tuple[int, ...]
    put: Callable[[Gear, Array], Gear]
    group: float = 0.0


@dataclass(frozen=True, eq=False)
class Library(ComparedByFields):
    """What one kind of part can add to the torque.

    Attributes:
        torques: of unit weights along the loop [N.m], shape (n, m)
        choices: to take one of
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
        weights: of each, and of what always takes part
        error: root of the sum of the squared residuals [N.m]
    """

    choices: tuple[Choice, ...]
    weights: tuple[Array, ...]
    error: float

    def put(self, gear: Gear) -> Gear:
        """The gear with all of it."""
        for choice, weights in zip(self.choices, self.weights, strict=False):
            gear = choice.put(gear, weights)
        return gear


def solve(sought: Array, libraries: Sequence[Library], always: Array, most: int = 1) -> list[Answer]:
    """Those choices of each library that explain the torque sought best, with positive weights.

    Of given choices the weights are a convex problem, non-negative least squares (LawsonHanson1974), which the triangle
    of one QR decomposition of all columns holds as well as the columns. The libraries are gone through in turn until nothing
    improves.

    Args:
        sought: torque to explain [N.m], shape (n,)
        libraries: kinds of parts; one choice of each is taken
        always: columns that take part whatever is chosen, shape (n, k)
        most: how many answers are wanted

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
    triangle = np.asarray(np.linalg.qr(np.column_stack((matrix / size, sought)), mode="r"), float)
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
    for _ in range(ROUNDS):
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
        raise ValueError("no spring and hysteresis fits this loop")
    parted = next((place for place, each in enumerate(libraries) if len({choice.group for choice in each.choices}) > 1), 0)
    of_groups: dict[float, Answer] = {}
    for answer in sorted(answers.values(), key=lambda answer: answer.error):
        of_groups.setdefault(answer.choices[parted].group, answer)
    return [*of_groups.values()][:most]


def _positive(matrix: Array, sought: Array) -> tuple[Array, float] | None:
    """Non-negative weights and what they leave; nothing where the active set cycles: other choices remain."""
    from scipy.optimize import nnls

    try:
        weights, error = nnls(matrix, sought)
    except RuntimeError:
        return None
    return weights, float(error)
