"""Answers to a study's own questions, by condition: scales, yes and no, choices, two intervals, staircases, text.

Each function takes the tidy table (table.py). Rows that are void, and rows without an answer to the question, do not count.
Results are dicts. Tests are over participants, because trials of one participant are not independent.
"""
import math

import numpy as np
from scipy import special

from .statistics import dprime_of_hits, friedman, holm, mean, median, t_interval, wilcoxon


# ---- which rows, and which groups


def questions_of(table):
    """The kind of each question: what the study's files say of it; else by its answers."""
    told = table.attrs.get("questions", {})
    kinds = {}
    for column in table.columns:
        if column in told:
            kinds[column] = told[column]["Kind"]
        elif f"{column}_time" in table.columns:
            values = set(table[column].dropna())
            kinds[column] = ("number" if table[column].dtype != object else "yes-no" if values <= {"yes", "no"} else
                             "choice" if len(values) <= 16 else "text")
    return kinds


def answered(table, question):
    """The rows that count: of trials, with an answer, not void."""
    if question not in table.columns:
        raise KeyError(f"the table has no question {question}: it has {', '.join(questions_of(table))}")
    rows = table[~table["void"] & table[question].notna()]
    return rows[rows["block"].isin(["trial", "pair"])] if "block" in rows and rows["block"].isin(["trial", "pair"]).any() else rows


def group_names(rows):
    """The condition of each row, and its method where there are several."""
    methods = rows["method"].dropna().unique() if "method" in rows else ()
    if len(methods) < 2:
        return rows["condition"].astype(str)
    return rows["condition"].astype(str) + ", " + rows["method"].fillna("no method").astype(str)


def groups_of(table, question):
    """The rows that count, by condition (and method, where there are several), in the order of their names."""
    rows = answered(table, question)
    return {name: part for name, part in rows.groupby(group_names(rows), sort=True)}


def quartiles(values):
    low, high = np.quantile(values, [0.25, 0.75])
    return [float(low), float(high)]


# ---- scales and numbers


def scales(table, question):
    """Medians of a scale, or of another number, by condition: each participant counts with the median of their answers.
    Friedman's test of all conditions, and Wilcoxon's exact test of each two, with Holm's correction."""
    of_people = {name: {number: float(part[question].median()) for number, part in rows.groupby("participant")}
                 for name, rows in groups_of(table, question).items()}
    found = [{"group": name, "participants": len(people), "median": median(list(people.values())), "quartiles": quartiles(list(people.values())),
              "mean": mean(list(people.values())), "t_interval": t_interval(list(people.values()))} for name, people in of_people.items()]
    names, pairs = list(of_people), []
    for i, a in enumerate(names):
        for b in names[i + 1:]:
            both = sorted(of_people[a].keys() & of_people[b].keys())
            if not both:
                continue
            differences = [of_people[b][number] - of_people[a][number] for number in both]
            pairs.append({"a": a, "b": b, "participants": len(both), "median_difference": median(differences), "wilcoxon": wilcoxon(differences)})
    for pair, p in zip(pairs, holm([pair["wilcoxon"]["p_two_sided"] for pair in pairs])):
        pair["p_holm"] = p
    everybody = sorted(set.intersection(*map(set, of_people.values()))) if of_people else []
    tested = len(names) > 2 and len(everybody) > 1
    return {"question": question, "kind": "scale", "groups": found, "pairs": pairs,
            "friedman": friedman([[of_people[name][number] for name in names] for number in everybody]) if tested else None}


# ---- yes and no


def yes_no(table, question, noise="silent", yes="yes"):
    """d' and criterion of each condition beside catch trials, the conditions of `noise`. Half a trial is added to each of
    the four cells of a participant. d' = z(H) - z(F), criterion = -(z(H) + z(F)) / 2: above 0, people say no more often."""
    noise = {noise} if isinstance(noise, str) else set(noise)
    rows = answered(table, question)
    says_yes, is_noise = rows[question] == yes, rows["condition"].isin(noise)
    alarms = {number: (int(part.sum()), len(part)) for number, part in says_yes[is_noise].groupby(rows["participant"][is_noise])}
    found = []
    for name, part in groups_of(table, question).items():
        shares = [float((own[question] == yes).mean()) for _, own in part.groupby("participant")]
        group = {"group": name, "trials": len(part), "yes": int((part[question] == yes).sum()), "participants": len(shares), "mean_share": mean(shares)}
        if not part["condition"].isin(noise).any():
            own = []
            for number, trials in part.groupby("participant"):
                false, all_noise = alarms.get(number, (0, 0))
                hits = int((trials[question] == yes).sum())
                d = dprime_of_hits(hits, len(trials), false, all_noise)
                if d is None:
                    continue
                z_hits, z_alarms = special.ndtri((hits + 0.5) / (len(trials) + 1)), special.ndtri((false + 0.5) / (all_noise + 1))
                own.append({"participant": int(number), "dprime": d, "criterion": float(-(z_hits + z_alarms) / 2)})
            values = [one["dprime"] for one in own]
            group |= {"dprime": mean(values) if own else None, "t_interval": t_interval(values),
                      "criterion": mean([one["criterion"] for one in own]) if own else None, "people": own}
        found.append(group)
    return {"question": question, "kind": "yes-no", "noise": sorted(noise), "groups": found}


# ---- choices and text


def choices(table, question):
    """How often each answer was given, by condition."""
    groups = groups_of(table, question)
    answers = sorted({str(answer) for rows in groups.values() for answer in rows[question]})
    return {"question": question, "kind": "choice", "answers": answers,
            "groups": [{"group": name, "participants": int(rows["participant"].nunique()), "trials": len(rows),
                        "counts": [int((rows[question].astype(str) == answer).sum()) for answer in answers]} for name, rows in groups.items()]}


def text_answers(table, question):
    """Every text, with who wrote it and after what."""
    rows = answered(table, question)
    return {"question": question, "kind": "text",
            "answers": [{"participant": int(number), "group": name, "text": str(text)}
                        for number, name, text in zip(rows["participant"], group_names(rows), rows[question])]}


# ---- all questions


def answers_of(table, seed=0):
    """What each question of the table says, by its kind. (Which shape it was is what analyse() is about.)"""
    found = []
    for question, kind in questions_of(table).items():
        if kind == "shape" or answered(table, question).empty:
            continue
        if kind in ("pair", "staircase") and {"level", "correct"} <= set(table.columns):
            from .psychometric import thresholds
            found.append(thresholds(table, question, seed=seed))
        elif kind in ("scale", "number"):
            found.append(scales(table, question))
        elif kind == "yes-no":
            found.append(yes_no(table, question))
        elif kind == "text":
            found.append(text_answers(table, question))
        else:
            found.append(choices(table, question))
    return found
