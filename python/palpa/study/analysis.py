"""What a study of "which shape was it?" says: by method, between methods, over the trials; tables beside each other; and
how many participants it takes.

Results are dicts with the keys that `--json` writes.
"""
import math
import os
import warnings

import numpy as np
from scipy import special

from .counts import tables_of
from .reading import BIN_S, TABLE, read_study
from .statistics import (GAMMA, WORD, Confusion, bootstrap_interval, clopper_pearson, cohens_d, deviation, dprime, draws, friedman,
                         hodges_lehmann, holm, information, mean, measures, median, pearson, rank_sum, resamples_for, spearman,
                         t_interval, two_tables, uniforms, wilcoxon)
from .text import BadInput

BLOCKS = 4  # the trials of a session, in as many blocks of the same length


class Person:
    """One participant with one method."""

    def __init__(self, study, number, method, turn):
        self.person, self.method, self.turn = number, method, turn
        self.trials = [trial for trial in study.participants[number].trials if trial.method == method]
        self.table = Confusion(study.shapes)
        for trial in self.trials:
            self.table.counts[trial.shape][trial.answer] += 1

    @property
    def times(self):
        return [trial.response_s for trial in self.trials if trial.response_s is not None]


def people_of(study):
    """By participant, then method; only with trials."""
    people = []
    for number, participant in enumerate(study.participants):
        turns = list(dict.fromkeys(trial.method for trial in participant.trials))
        people += [Person(study, number, method, turns.index(method) + 1) for method in sorted(turns)]
    return people


# ---- by method


def learning(people):
    """Accuracy over the trials with one method, and the gain of the second half over the first."""
    blocks, gains = [], []
    for one in people:
        hits, n = [trial.correct for trial in one.trials], len(one.trials)
        if n < BLOCKS:
            continue
        ends = [n * block // BLOCKS for block in range(BLOCKS + 1)]
        blocks.append([sum(hits[a:b]) / (b - a) for a, b in zip(ends, ends[1:])])
        # As a quotient of whole numbers: equal gains are equal doubles.
        first, second = n // 2, n - n // 2
        gains.append((sum(hits[first:]) * first - sum(hits[:first]) * second) / (first * second))
    return {"block_accuracy": [mean(block) for block in zip(*blocks)], "mean_gain": mean(gains) if gains else None,
            "gain_of_second_half": wilcoxon(gains)}


def answer_times(people):
    """Medians over participants of each participant's median."""
    def of(choose):
        medians = [median([trial.response_s for trial in one.trials if trial.response_s is not None and choose(trial)]) for one in people]
        return [one for one in medians if one is not None]
    every = of(lambda trial: True)
    return {"participants": len(every), "median_s": median(every), "correct_s": median(of(lambda trial: trial.correct)),
            "wrong_s": median(of(lambda trial: not trial.correct))}


def mean_depth(study, method, shape):
    """The depth of the finger below the top of the object over the time in a trial, over participants; None in a bin in
    which nobody has a sample."""
    sums, people = [], []
    for participant in study.participants:
        of_person, samples = participant.depths.get((method, shape), ([], []))
        sums += [0.0] * (len(samples) - len(sums))
        people += [0] * (len(samples) - len(people))
        for place, (value, number) in enumerate(zip(of_person, samples)):
            if number:
                sums[place] += value / number
                people[place] += 1
    return [value / number if number else None for value, number in zip(sums, people)]


def method_result(study, people, method, seed):
    of_method = [one for one in people if one.method == method]
    pooled = Confusion(study.shapes)
    for one in of_method:
        pooled.counts = [[a + b for a, b in zip(*rows)] for rows in zip(pooled.counts, one.table.counts)]
    accuracies = [one.table.accuracy for one in of_method]
    result = {"name": study.methods[method], "participants": len(of_method),
              "void": sum(participant.voids[method] for participant in study.participants),
              "void_by_shape": [sum(voids) for voids in zip(*(participant.void_shapes[method] for participant in study.participants))],
              "mean_accuracy": mean(accuracies), "deviation": deviation(accuracies), "t_interval": t_interval(accuracies),
              "bootstrap_interval": bootstrap_interval(accuracies, seed), **measures(pooled), "learning": learning(of_method),
              "answer_times": answer_times(of_method)}
    if any(participant.depths for participant in study.participants):
        result["depth"] = {"bin_s": BIN_S} | {shape: mean_depth(study, method, place) for place, shape in enumerate(study.shapes)}
    return result, pooled


# ---- between methods: all tests are over participants, because trials of one participant are not independent


def difference(a, b):
    """b - a, from whole numbers and divided once, so that equal differences are equal doubles."""
    return (b.correct * a.total - a.correct * b.total) / (a.total * b.total)


def method_pair(study, people, pooled, a, b, seed):
    """The later method minus the earlier one; None if nobody used both."""
    of = {(one.person, one.method): one for one in people}
    kept, every, excluded = [], [], []
    for number, participant in enumerate(study.participants):
        one, other = of.get((number, a)), of.get((number, b))
        if one is None or other is None:
            if (one or other) and study.least_trials > 0:
                excluded.append(participant.number)
            continue
        every.append(difference(one.table, other.table))
        if min(one.table.total, other.table.total) < study.least_trials:
            excluded.append(participant.number)
        else:
            kept.append((one, other, every[-1]))
    if not every:
        return None
    differences = [d for _, _, d in kept]
    pair = {"a": study.methods[a], "b": study.methods[b], "participants": len(kept), "differences": differences, "excluded": excluded}
    if len(every) > len(kept):
        pair["with_excluded"] = {"mean": mean(every), "wilcoxon": wilcoxon(every)}
    estimate, interval = hodges_lehmann(differences) if kept else (None, None)
    of_a, of_b = [one.table.accuracy for one, _, _ in kept], [other.table.accuracy for _, other, _ in kept]
    first = [d for one, other, d in kept if one.turn < other.turn]
    second = [d for one, other, d in kept if one.turn > other.turn]
    ranks, p = rank_sum(first, second) if first and second else (None, None)
    return pair | {
        "mean": mean(differences) if kept else None, "t_interval": t_interval(differences),
        "bootstrap_interval": bootstrap_interval(differences, seed), "cohens_d": cohens_d(differences), "hodges_lehmann": estimate,
        "hodges_lehmann_interval": interval, "wilcoxon": wilcoxon(differences), "wilcoxon_pratt": wilcoxon(differences, "pratt"),
        "p_holm": None, "pearson": pearson(of_a, of_b), "spearman": spearman(of_a, of_b),
        "order": {"differences_a_first": first, "differences_b_first": second, "rank_sum": ranks, "p": p},
        "tables": two_tables(pooled[a], pooled[b])}


def friedman_of(study, people):
    """Friedman's test over the participants who used all methods enough."""
    rows = []
    for number in range(len(study.participants)):
        row = [one.table.accuracy for one in people if one.person == number and one.table.total >= study.least_trials]
        if len(row) == len(study.methods):
            rows.append(row)
    return friedman(rows) if len(rows) > 1 else None


def analyse_study(study, seed=0):
    """All numbers of a study that was read. The same study and seed give the same numbers."""
    people, count = people_of(study), len(study.methods)
    methods, pooled = zip(*(method_result(study, people, method, seed) for method in range(count)))
    pairs = [method_pair(study, people, pooled, a, b, seed) for a in range(count) for b in range(a + 1, count)]
    pairs = [pair for pair in pairs if pair]
    if count > 2:
        tested = [pair for pair in pairs if pair["participants"]]
        for pair, p in zip(tested, holm([pair["wilcoxon"]["p_two_sided"] for pair in tested])):
            pair["p_holm"] = p
    return {
        "kind": "palpa study analyse", "version": 1, "seed": seed, "resamples": resamples_for(len(study.participants)),
        "shapes": study.shapes, "least_trials": study.least_trials, "methods": list(methods), "pairs": pairs,
        "friedman": friedman_of(study, people) if count > 2 else None,
        "participants": [
            {"participant": study.participants[one.person].number, "method": study.methods[one.method], "turn": one.turn,
             "trials": one.table.total, "void": study.participants[one.person].voids[one.method], "correct": one.table.correct,
             "accuracy": one.table.accuracy, "dprime": dprime(one.table.correct, one.table.total, len(study.shapes)),
             "bits": information(one.table)["bits"], "answer_time_s": median(one.times), "counts": one.table.counts} for one in people],
        "felt_nothing": [{"participant": one.number, "asked": one.asked, "felt_nothing": one.unfelt} for one in study.participants if one.asked],
        "left_out": study.left_out}


def analyse(folders, seed=0):
    """The results of one or several folders of a study: of "which shape was it?", and, where there is a trials.tsv, of the
    study's own questions (`answers`)."""
    folders = [folders] if isinstance(folders, str) or hasattr(folders, "__fspath__") else list(folders)
    folders = [os.fspath(folder) for folder in folders]
    asks = any(os.path.exists(os.path.join(folder, TABLE)) for folder in folders)
    try:
        result = analyse_study(read_study(folders), seed)
    except BadInput:
        if not asks:
            raise
        result = {"kind": "palpa study analyse", "version": 1, "seed": seed, "shapes": [], "methods": [], "pairs": [], "friedman": None,
                  "participants": [], "felt_nothing": [], "left_out": []}
    if asks:
        from .answers import answers_of
        from .table import load
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            table = load(*folders)
        result["answers"] = answers_of(table, seed)
        result["left_out"] += [line for line in table.attrs["left_out"] if line not in result["left_out"]]
    return result


# ---- tables beside each other


def compare_tables(tables, left_out=()):
    """Named tables beside each other. Shapes may be in another order: all tables get the order of the first that has the
    same shapes."""
    done, pairs, left_out = [], [], list(left_out)
    for i, (name, table) in enumerate(tables):
        first = next(other for _, other in tables if sorted(other.shapes) == sorted(table.shapes))
        table = table.in_order(first.shapes)
        for j, other in enumerate(done):
            if other[1].shapes == table.shapes:
                pairs.append({"a": other[0], "b": name, "tables": two_tables(other[1], table)})
            else:
                left_out.append(f"{other[0]} ({', '.join(other[1].shapes)}) and {name} ({', '.join(table.shapes)}) have different "
                                "shapes, so they are not compared")
        done.append((name, table))
    return {"kind": "palpa study analyse" if len(done) == 1 else "palpa study compare", "version": 1,
            "tables": [{"name": name, "shapes": table.shapes, **measures(table)} for name, table in done], "pairs": pairs, "left_out": left_out}


def compare(sources):
    """Results beside each other: folders of studies, tables of counts, JSON files of earlier results, the word "paper"."""
    tables, left_out = [], []
    for source in map(str, sources):
        more, lines = tables_of(source)
        tables += more
        left_out += lines
    return compare_tables(tables, left_out)


# ---- how many participants

PAPER_CORRELATION, ITS_INTERVAL = 0.77, (0.27, 0.94)  # of ten people (Fisher)
SETTING = {"accuracies": [0.39, 0.6525], "spread": 0.1, "correlation": PAPER_CORRELATION, "trials": 40, "alpha": 0.05, "power": 0.8,
           "studies": 2000, "people": 200, "seed": 0}


class Simulation:
    """Studies of people who have an accuracy of their own for each of two methods: its mean plus a normal deviation, kept
    within 0 and 1. The deviations of one person are correlated. Correct answers are binomial."""

    def __init__(self, setting):
        self.setting = setting
        numbers = draws(np.arange(setting["studies"], dtype=np.uint64), 1)  # a stream of its own for each study
        self.seeds = np.uint64(setting["seed"] * GAMMA & WORD) + numbers
        self.differences = np.zeros((setting["studies"], 0), int)
        self.rows = {}

    def simulate(self, people):
        """Adds people until each study has that many."""
        s, trials = self.setting, self.setting["trials"]
        rest, each = math.sqrt(max(0.0, 1 - s["correlation"] ** 2)), 2 + 2 * trials
        for person in range(self.differences.shape[1], people):
            steps = np.arange(person * each + 1, (person + 1) * each + 1, dtype=np.uint64)
            uniform = uniforms(draws(self.seeds[:, None], steps[None, :]))
            first = special.ndtri(uniform[:, 0])
            second = s["correlation"] * first + rest * special.ndtri(uniform[:, 1])
            a, b = (np.clip(accuracy + s["spread"] * own, 0, 1)[:, None] for accuracy, own in zip(s["accuracies"], (first, second)))
            right = (uniform[:, 2 + trials:] < b).sum(1) - (uniform[:, 2:2 + trials] < a).sum(1)
            self.differences = np.column_stack([self.differences, right])

    def power(self, people):
        """The share of studies of the first `people` in which Wilcoxon's exact test finds the difference."""
        if people not in self.rows:
            self.simulate(people)
            studies = self.differences[:, :people].tolist()
            found = sum(wilcoxon(study)["p_two_sided"] <= self.setting["alpha"] for study in studies)
            self.rows[people] = {"participants": people, "found": found, "power": found / len(studies),
                                 "interval": clopper_pearson(found, len(studies))}
        return self.rows[people]["power"]


def least_people(setting):
    """The least number of people who reach the wanted power (None if `people` do not), and what was simulated. The
    numbers that are tried are those from 2 to 20, then steps up to `people`, and what a bisection needs."""
    simulation, most, low, high = Simulation(setting), setting["people"], 1, 0
    people = min(2, most)
    while people <= most:
        if simulation.power(people) >= setting["power"]:
            high = people
            break
        low = people
        if people == most:
            break
        people = min(most, people + 1 if people < 20 else people + max(1, people // 4))
    while high > low + 1:
        middle = low + (high - low) // 2
        if simulation.power(middle) >= setting["power"]:
            high = middle
        else:
            low = middle
    return high or None, [simulation.rows[people] for people in sorted(simulation.rows)]


def power(**changes):
    """How many participants a study needs, by simulation. `changes` of SETTING: accuracies, spread, correlation, trials,
    alpha, power, studies, people (the most that are tried), seed."""
    unknown = changes.keys() - SETTING.keys()
    if unknown:
        raise TypeError(f"power() has no {', '.join(sorted(unknown))}: give {', '.join(SETTING)}")
    setting = SETTING | changes
    participants, rows = least_people(setting)
    others = ITS_INTERVAL if setting["correlation"] == PAPER_CORRELATION else ()
    return {**{key: setting[key] for key in ("accuracies", "spread", "correlation", "trials", "alpha", "power", "studies", "seed")},
            "participants": participants,
            "other_correlations": [{"correlation": other, "participants": least_people(setting | {"correlation": other})[0]} for other in others],
            "rows": rows, "people": setting["people"]}


def mean_within_bounds(accuracy, spread):
    """The mean accuracy of simulated participants, which is another one if deviations beyond 0 or 1 are cut off."""
    def cut(z):
        return math.exp(-z * z / 2) / math.sqrt(2 * math.pi) - z * math.erfc(z / math.sqrt(2)) / 2
    return accuracy if spread <= 0 else accuracy + spread * (cut(accuracy / spread) - cut((1 - accuracy) / spread))
