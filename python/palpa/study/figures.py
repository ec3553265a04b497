"""The figures of reports, each a figure of matplotlib; and their bytes, which are the same for the same figure."""
import io
import math
import re

import matplotlib
from matplotlib.figure import Figure

from .text import printable, shortened

# Okabe and Ito's colours, which colour-blind people can tell apart. In print without colours, series differ in lightness,
# dashes and markers.
SERIES = [("#e69f00", "-", "o"), ("#0072b2", "--", "s"), ("#009e73", ":", "^"), ("#d55e00", "-.", "D"), ("#56b4e9", "-", "s"),
          ("#cc79a7", "--", "^"), ("#333333", ":", "D"), ("#999933", "-.", "o")]
LOOK = {"svg.hashsalt": "palpa", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9, "axes.spines.top": False,
        "axes.spines.right": False, "axes.axisbelow": True, "text.parse_math": False}


def look(place):
    """The colour, dashes and marker of a series."""
    colour, dashes, marker = SERIES[place % len(SERIES)]
    return {"color": colour, "linestyle": dashes, "marker": marker}


def axes_of(width, height, **labels):
    """Axes of a figure of that size in inches, with these labels of x and y."""
    with matplotlib.rc_context(LOOK):
        axes = Figure(figsize=(width, height), layout="constrained").subplots()
        axes.set(**labels)
        return axes


def words(text):
    """A name as a label: unseen characters are escaped, and long names are shortened."""
    return shortened(printable(text), 46).encode("utf-8", "replace").decode()


def svg_of(figure, number=0):
    """The drawing as text that fits into a page. The same figure and number give the same bytes."""
    out = io.StringIO()
    with matplotlib.rc_context(LOOK):
        figure.savefig(out, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    text = out.getvalue()
    # Several drawings are in one page, in which each name may stand only once.
    return re.sub(r'(\bid="|url\(#|href="#)', rf"\1f{number}-", text[text.index("<svg"):])


def draw_chance(axes, chance):
    axes.axhline(chance, color="#a00", linewidth=0.8)
    axes.annotate("chance", (1, chance), xycoords=("axes fraction", "data"), xytext=(3, 0), textcoords="offset points", va="center",
                  color="#a00", fontsize=8)


def share_axis(axes):
    axes.set_ylim(0, 1)
    axes.grid(axis="y", color="#ddd")


def legend(axes, count):
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=min(count, 4), frameon=False)


def accuracy(result):
    """One group of bars per participant, and one for the means with their standard deviations."""
    names, methods = [method["name"] for method in result["methods"]], result["methods"]
    people = list(dict.fromkeys(one["participant"] for one in result["participants"]))
    place = {number: i for i, number in enumerate(people)}
    axes = axes_of(min(9.0, 3 + 0.5 * len(people)), 3.4, xlabel="participant", ylabel="accuracy")
    bar, wide = 0.8 / len(names), max(1.0, len(people) / 16)  # the bars of the means are wider if there are many people
    at_mean = len(people) + wide / 2
    for m, method in enumerate(methods):
        shift = bar * (m - (len(names) - 1) / 2)
        of_method = [one for one in result["participants"] if one["method"] == method["name"]]
        style = {"color": SERIES[m % len(SERIES)][0], "edgecolor": "#333", "linewidth": 0.5 if len(people) < 40 else 0}
        axes.bar([place[one["participant"]] + shift for one in of_method], [one["accuracy"] for one in of_method], width=bar,
                 label=words(method["name"]), **style)
        average, spread = method["mean_accuracy"], method["deviation"]
        if not math.isfinite(average):
            continue
        ends = None if spread is None else [[min(spread, average)], [min(spread, 1 - average)]]
        axes.bar([at_mean + wide * shift], [average], width=wide * bar, yerr=ends, capsize=3, **style)
    every = math.ceil(len(people) / 24)
    axes.set_xticks([*range(0, len(people), every), at_mean], [*map(str, people[::every]), "mean"])
    share_axis(axes)
    draw_chance(axes, 1 / len(result["shapes"]))
    legend(axes, len(names))
    return axes.figure


def confusion(table, shapes):
    """Shares of the answers, from white to dark blue."""
    m, names = len(shapes), [shortened(words(shape), 14) for shape in shapes]
    size = min(max(6 / m, 0.4), 1.0) * m
    axes = axes_of(size + 1.6, size + 1.2, xlabel="answer", ylabel="actual shape")
    shares = [[count / sum(row) if sum(row) else 0.0 for count in row] for row in table["counts"]]
    # Rectangles instead of a picture, which would be a PNG inside the drawing.
    axes.pcolormesh(shares, cmap="Blues", vmin=0, vmax=1, edgecolors="#333", linewidth=0.5)
    axes.set(aspect="equal", xlim=(0, m), ylim=(m, 0))
    axes.set_xticks([i + 0.5 for i in range(m)], names, rotation=45 if max(map(len, names)) > 10 else 0, ha="left" if max(map(len, names)) > 10 else "center")
    axes.set_yticks([i + 0.5 for i in range(m)], names)
    axes.xaxis.tick_top()
    axes.xaxis.set_label_position("top")
    if m <= 16:
        for i, row in enumerate(shares):
            for j, share in enumerate(row):
                axes.text(j + 0.5, i + 0.5, f"{share:.2f}", ha="center", va="center", color="white" if share > 0.65 else "#111")
    return axes.figure


def learning(result):
    axes = axes_of(6, 3.2, xlabel="quarter of the trials", ylabel="accuracy")
    for m, method in enumerate(result["methods"]):
        quarters = method["learning"]["block_accuracy"]
        if quarters:
            axes.plot(range(1, len(quarters) + 1), quarters, label=words(method["name"]), **look(m))
    axes.set_xticks(range(1, 5))
    axes.set_xlim(0.5, 4.5)
    share_axis(axes)
    draw_chance(axes, 1 / len(result["shapes"]))
    if axes.lines[1:]:
        legend(axes, len(result["methods"]))
    return axes.figure


def depths(result, method):
    """The mean depth of the finger with one method, by time in the trial; deeper is lower."""
    axes = axes_of(6.6, 3.2, xlabel="time in the trial (s)", ylabel="depth (mm)")
    bin_s = method["depth"]["bin_s"]
    for s, shape in enumerate(result["shapes"]):
        values = [math.nan if value is None else 1e3 * value for value in method["depth"][shape]]
        if values:
            axes.plot([bin_s * (i + 0.5) for i in range(len(values))], values, label=words(shape), **look(s) | {"marker": ""})
    axes.grid(axis="y", color="#ddd")
    axes.invert_yaxis()
    if axes.lines:
        legend(axes, len(result["shapes"]))
    return axes.figure


def accuracies(tables):
    """The accuracies of several tables, with their intervals."""
    axes = axes_of(8, 1 + 0.35 * len(tables), xlabel="accuracy")
    for i, table in enumerate(tables):
        low, high = table["clopper_pearson"]
        colour, _, marker = SERIES[i % len(SERIES)]
        axes.plot([low, high], [i, i], color="#111", linewidth=1.2)
        axes.plot([table["accuracy"]], [i], color=colour, marker=marker, markeredgecolor="#333")
    axes.set_yticks(range(len(tables)), [words(table["name"]) for table in tables])
    axes.set(xlim=(0, 1), ylim=(len(tables) - 0.5, -0.5))
    axes.grid(axis="x", color="#ddd")
    return axes.figure


def power(result):
    axes, rows = axes_of(6, 3.2, xlabel="participants", ylabel="power"), result["rows"]
    axes.axhline(result["power"], color="#a00", linewidth=0.8)
    people, shares = [row["participants"] for row in rows], [row["power"] for row in rows]
    ends = [[max(0.0, row["power"] - row["interval"][0]) for row in rows], [max(0.0, row["interval"][1] - row["power"]) for row in rows]]
    axes.errorbar(people, shares, yerr=ends, capsize=3, ecolor="#111", **look(1))
    axes.set_xlim(0, max([2, *people]) + 1)
    share_axis(axes)
    return axes.figure


# ---- of a study's own questions


def by_condition(found, label):
    """Medians with quartiles of a scale, or shares and d' with their intervals: one point per condition."""
    names = list(found)
    axes = axes_of(min(9.0, 2.5 + 0.9 * len(names)), 3.2, ylabel=label)
    for i, name in enumerate(names):
        value, (low, high) = found[name]
        axes.plot([i, i], [low, high], color="#111", linewidth=1.2)
        axes.plot([i], [value], **look(i))
    axes.set_xticks(range(len(names)), [words(name) for name in names], rotation=30 if max(map(len, names)) > 10 else 0,
                    ha="right" if max(map(len, names)) > 10 else "center")
    axes.set_xlim(-0.5, len(names) - 0.5)
    axes.grid(axis="y", color="#ddd")
    return axes.figure


def psychometric(fits, label):
    """Shares of right answers by level, as large as their number of trials, and the fitted functions."""
    from .psychometric import right_at
    axes = axes_of(6.4, 3.4, xlabel=label, ylabel="right answers")
    for i, (name, fit) in enumerate(fits.items()):
        colour = SERIES[i % len(SERIES)][0]
        levels, trials, right = zip(*fit["levels"])
        axes.scatter(levels, [r / n for r, n in zip(right, trials)], s=[8 + 60 * n / max(trials) for n in trials], color=colour, edgecolor="#333",
                     linewidth=0.5, marker=SERIES[i % len(SERIES)][2], label=words(name), clip_on=False)
        low, high = min(levels), max(levels)
        curve = [low + (high - low) * k / 100 for k in range(101)]
        axes.plot(curve, [right_at(fit, level) for level in curve], **look(i) | {"marker": ""})
        if fit["threshold"] is not None:
            axes.plot(fit["interval"], [fit["share"] - 0.012 * i] * 2, color=colour, linewidth=2)
    share_axis(axes)
    axes.axhline(next(iter(fits.values()))["chance"], color="#a00", linewidth=0.8)
    legend(axes, len(fits))
    return axes.figure
