"""Terms that explain a torque, one after another, for as long as they predict rows that they were not chosen by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]

MAX_TERMS = 40  # terms
MAX_IDLE_TERMS = 4  # terms that may bring nothing before the search ends
MAX_STEP_ERROR = 0.99  # of the error, that the terms of a step must leave at most
MIN_INDEPENDENT = 1e-3  # of the size of a term, that terms before it must not explain


@dataclass(frozen=True, eq=False)
class Selection:
    """Forward selection of terms by orthogonal least squares (ChenBillingsLuo1989), checked on other blocks of time.

    Attributes:
        torque: shape (n,)
        base: columns that every joint has, shape (n, b)
        weights: of terms that explain as much, shape (t,)
        train, check: rows that terms are chosen by, and those that check them, shape (n,)
    """

    torque: Array
    base: Array
    weights: Array
    train: NDArray[np.bool_]
    check: NDArray[np.bool_]

    def best(self, columns: Array) -> list[int]:
        """Return the places of the columns to add, in the order in which they explain."""
        chosen: list[int] = []
        errors = [self.error(columns[:, chosen])]
        left = columns[self.train] / np.maximum(np.linalg.norm(columns[self.train], axis=0), 1e-300)
        orthogonal, _ = np.linalg.qr(self.base[self.train])
        left -= orthogonal @ (orthogonal.T @ left)
        rest = self.torque[self.train] - orthogonal @ (orthogonal.T @ self.torque[self.train])
        while len(chosen) < min(MAX_TERMS, columns.shape[1]):
            squares = np.einsum("ij,ij->j", left, left)
            explained = (rest @ left) ** 2 / np.maximum(squares, 1e-300)
            scores = np.where(squares > MIN_INDEPENDENT**2, self.weights * explained, 0.0)
            place = int(np.argmax(scores))
            if scores[place] == 0.0:
                break
            direction = left[:, place] / np.sqrt(squares[place])
            left -= np.outer(direction, direction @ left)
            rest -= direction * (direction @ rest)
            chosen.append(place)
            errors.append(self.error(columns[:, chosen]))
            if min(errors[-MAX_IDLE_TERMS:]) > MAX_STEP_ERROR * min(errors[:-MAX_IDLE_TERMS] or [np.inf]):
                break
        least = min(errors)
        return chosen[: next(count for count, error in enumerate(errors) if error <= least / MAX_STEP_ERROR)]

    def error(self, columns: Array) -> float:
        """Return the error of the rows that check, by the shares of the others, over how much the torque varies."""
        every = np.hstack([self.base, columns])
        left = self.torque[self.check] - every[self.check] @ solved(every[self.train], self.torque[self.train])
        return float(np.sqrt(np.mean(left**2)) / np.std(self.torque))


def independent(base: Array, columns: Array, least: float = MIN_INDEPENDENT) -> list[int]:
    """Return the columns of which at least a share is made up neither by a base nor by columns before them."""
    kept: list[int] = []
    orthogonal, _ = np.linalg.qr(base)
    for place, column in enumerate(columns.T):
        rest = column - orthogonal @ (orthogonal.T @ column)
        if np.linalg.norm(rest) > least * np.linalg.norm(column):
            kept.append(place)
            orthogonal = np.column_stack([orthogonal, rest / np.linalg.norm(rest)])
    return kept
