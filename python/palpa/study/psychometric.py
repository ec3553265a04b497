"""Thresholds of two-interval choices and staircases: the level at which people are right in a given share of trials, by a
psychometric function, with a bootstrap interval.

The share of right answers at a level is chance + (1 - chance - LAPSE) logistic((level - position) / width). With some forty
trials, a fit of the largest likelihood is often infinite: no width is too small, no threshold too far away. Threshold and
width therefore have weak prior distributions that only depend on the levels that were played: the threshold is near them, and
the function is neither a step nor flat over them. The estimate is the mean of the posterior distribution.
"""
import math

import numpy as np
from scipy import special

from .answers import answered, group_names
from .statistics import bootstrap_interval, mean, t_interval

LAPSE = 0.02  # the share of trials in which people press the wrong key, whatever they feel
# The prior distributions, in halves of the range of the levels that were played.
NEARNESS, WIDTH, FACTOR = 2.5, 0.19, math.exp(0.7)
PLACES, WIDTHS, REACH, WIDEST = 121, 15, 3.0, (0.015, 3.0)
RESAMPLES = 500


def right_at(fit, level):
    """The share of right answers at a level, of a fit."""
    return float(fit["chance"] + (1 - fit["chance"] - LAPSE) * special.expit((level - fit["position"]) / fit["width"]))


class Grid:
    """All thresholds and widths that are considered, and what they say of each level."""

    def __init__(self, levels, trials, chance, share, within=None):
        middle = float(np.average(levels, weights=trials))
        spread = float(levels[-1] - levels[0]) / 2
        low, high, narrow, wide = within or (middle - REACH * spread, middle + REACH * spread, *np.log(spread * np.array(WIDEST)))
        self.thresholds, self.widths = np.linspace(low, high, PLACES), np.exp(np.linspace(narrow, wide, WIDTHS))
        self.shift = float(special.logit((share - chance) / (1 - chance - LAPSE)))
        position = self.thresholds[:, None] - self.shift * self.widths
        right = chance + (1 - chance - LAPSE) * special.expit((levels[:, None, None] - position) / self.widths)
        self.right = right.reshape(len(levels), -1)
        near = -0.5 * ((self.thresholds - middle) / (NEARNESS * spread)) ** 2
        usual = -0.5 * (np.log(self.widths / spread / WIDTH) / math.log(FACTOR)) ** 2
        of_wrong = np.log1p(-self.right)
        self.of_right, self.of_none = np.log(self.right) - of_wrong, trials @ of_wrong + (near[:, None] + usual).ravel()

    def posterior(self, right):
        """The probability of each threshold and width, for these numbers of right answers by level; several rows at once, too."""
        likelihood = right @ self.of_right
        likelihood += self.of_none
        likelihood -= likelihood.max(-1, keepdims=True)
        weights = np.exp(likelihood, out=likelihood)
        return weights / weights.sum(-1, keepdims=True)

    def means(self, posterior):
        """The mean threshold of each row."""
        return posterior.reshape(-1, PLACES, WIDTHS).sum(-1) @ self.thresholds

    def around(self, posterior):
        """The ends of a finer grid, with room for what other answers of the same person would say."""
        both, ends = posterior.reshape(PLACES, WIDTHS), []
        for values, weights in ((self.thresholds, both.sum(1)), (np.log(self.widths), both.sum(0))):
            middle = float(weights @ values)
            reach = 8 * max(math.sqrt(float(weights @ (values - middle) ** 2)), float(values[1] - values[0]) / 2)
            ends += [max(values[0], middle - reach), min(values[-1], middle + reach)]
        return ends


def fit(levels, right, chance=0.5, share=0.75, seed=0):
    """The threshold of one person from the level of each trial and whether the answer was right.

    The interval is that of a parametric bootstrap: people are simulated with the shares that the posterior distribution
    expects, and fitted in the same way. The threshold is None for a single level, or if all answers or none were right."""
    levels, right = np.asarray(levels, float), np.asarray(right, bool)
    if levels.shape != right.shape or not np.isfinite(levels).all():
        raise ValueError("levels and right need one number and one truth per trial")
    places, of = np.unique(levels, return_inverse=True)
    trials, hits = np.bincount(of, minlength=len(places)), np.bincount(of, right, minlength=len(places))
    found = {"trials": len(levels), "chance": chance, "share": share, "threshold": None, "interval": None, "position": None, "width": None,
             "levels": [[float(level), int(n), int(k)] for level, n, k in zip(places, trials, hits)]}
    if len(places) < 2 or hits.sum() in (0, len(levels)):
        return found
    grid = Grid(places, trials, chance, share)
    for _ in range(2):  # finer where many trials leave few thresholds
        grid = Grid(places, trials, chance, share, grid.around(grid.posterior(hits)))
    posterior = grid.posterior(hits)
    threshold = float(grid.means(posterior)[0])
    of_widths = np.cumsum(posterior.reshape(PLACES, WIDTHS).sum(0))
    width = float(grid.widths[np.argmax(of_widths >= 0.5)])
    random = np.random.Generator(np.random.PCG64(seed))
    again = grid.means(grid.posterior(random.binomial(trials, grid.right @ posterior, (RESAMPLES, len(places)))))
    low, high = np.quantile(again, [0.025, 0.975])
    return found | {"threshold": threshold, "interval": [float(low), float(high)], "position": threshold - grid.shift * width, "width": width}


def thresholds(table, question, level="level", right="correct", chance=0.5, share=0.75, seed=0):
    """The threshold of each participant by condition, and their mean over participants. `level` is the column of the level
    that was played, `right` that of whether the answer was right."""
    for column in (level, right):
        if column not in table.columns:
            raise KeyError(f"the table has no column {column}, which the thresholds of {question} need")
    rows, groups = answered(table, question), []
    rows = rows[rows[level].notna() & rows[right].notna()]
    for name, part in rows.groupby(group_names(rows), sort=True):
        people = []
        for number, own in part.groupby("participant"):
            people.append({"participant": int(number)} | fit(own[level], own[right].astype(bool), chance, share, seed + int(number)))
        known = [one["threshold"] for one in people if one["threshold"] is not None]
        groups.append({"group": name, "participants": len(people), "threshold": mean(known) if known else None, "t_interval": t_interval(known),
                       "bootstrap_interval": bootstrap_interval(known, seed), "people": people})
    return {"question": question, "kind": "threshold", "chance": chance, "share": share, "groups": groups}
