"""Every number in the tables of the HTML reports is that of the JSON."""
import html
import json
import re

import pytest

import test_unlike_people as people
from commands import run

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?")


def tables_of(file):
    """Each table as its rows of cells, with the heading before it."""
    found, heading = [], ""
    for part in re.finditer(r"<h2[^>]*>(?P<heading>.*?)</h2>|<table.*?</table>", file.read_text(), re.DOTALL):
        heading = html.unescape(part["heading"] or heading)
        if part["heading"] is None:
            rows = re.findall(r"<tr.*?</tr>", part[0], re.DOTALL)
            found.append((heading, [[html.unescape(re.sub("<.*?>", "", cell)) for cell in re.findall(r"<t[hd].*?</t[hd]>", row, re.DOTALL)] for row in rows]))
    return found


def shown(value):
    if isinstance(value, list):
        return f"{shown(value[0])} to {shown(value[1])}"
    return "-" if value is None else value if isinstance(value, str) else str(value) if isinstance(value, int) else f"{value:.9f}"


def p(value):
    return f"p = {value!r}"


def compare(rows, expected):
    """The same cells, but numbers as exact as they are shown."""
    assert len(rows) == len(expected), (rows, expected)
    for row, wanted in zip(rows, expected):
        assert len(row) == len(wanted), (row, wanted)
        for cell, value in zip(row, wanted):
            value = shown(value)
            assert NUMBER.sub("#", cell) == NUMBER.sub("#", value), (row, wanted)
            for one, other in zip(NUMBER.findall(cell), NUMBER.findall(value)):
                digits = len(one.partition(".")[2])
                near = pytest.approx(float(other), rel=6e-3) if "p = " in cell or "e" in one else pytest.approx(float(other), abs=0.51 * 10.0 ** -digits)
                assert float(one) == near, (row, wanted)


def measures(table, shapes):
    """The three tables that each table of answers has."""
    pairs = [(i, j) for i in range(len(shapes)) for j in range(i)]
    pairs = sorted((j, i) for i, j in pairs)
    luce, information = table["luce_fit"], table["information"]
    assert [(one["a"], one["b"]) for one in table["dprime_pairs"]] == [(shapes[i], shapes[j]) for i, j in pairs]
    return [
        [[shape, sum(table["counts"][i]), table["recall"][i], table["precision"][i], luce["bias"][i]] for i, shape in enumerate(shapes)],
        [[f"{shapes[i]}, {shapes[j]}", one["dprime"], luce["similarity"][i][j]] for one, (i, j) in zip(table["dprime_pairs"], pairs)],
        [["accuracy", table["accuracy"]], ["95 % interval (Clopper-Pearson)", table["clopper_pearson"]],
         ["p of at least as many correct answers by chance", p(table["p_chance"])], ["d' of all shapes", table["dprime"]],
         ["transmitted information", f"{information['bits']} of {information['most_bits']} bit"],
         ["corrected for the number of trials", f"{information['corrected_bits']} bit"],
         ["fit of Luce's model", f"G2 = {luce['deviance']} with {luce['degrees']} degrees of freedom, {p(luce['p'])}"]],
    ]


def differences(table, shapes):
    """The table of two methods' answers, shape by shape."""
    return [[name, one["chi_square"], one["likelihood_ratio"], one["degrees"], re.sub("p = ", "", p(one["p"]))]
            for name, one in zip([*shapes, "all"], [*table["rows"], table])]


def compare_differences(rows, table, shapes):
    wanted = differences(table, shapes)
    compare([row[:-1] for row in rows], [row[:-1] for row in wanted])
    compare([["p = " + row[-1]] for row in rows], [["p = " + row[-1]] for row in wanted])


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A study of four people; two began with the other method."""
    folder = tmp_path_factory.mktemp("reports")
    people.write_study(folder / "study", people.PEOPLE)
    for first in (folder / "study").glob("sub-[24]/beh/*_run-1_*"):
        second = first.with_name(first.name.replace("run-1", "run-2"))
        one, other = first.read_text(), second.read_text()
        first.write_text(other)
        second.write_text(one)
    run(["study", "analyse", str(folder / "study"), "--quiet", "--html", str(folder / "a.html"), "--json", str(folder / "a.json")])
    return folder


def test_of_an_analysis(study):
    j, tables = json.loads((study / "a.json").read_text()), tables_of(study / "a.html")
    shapes, (pair,) = j["shapes"], j["pairs"]
    assert {one["turn"] for one in j["participants"] if one["method"] == "single-focus"} == {1, 2}
    of = {heading: [rows[1:] for other, rows in tables if other == heading] for heading, _ in tables}
    compare(of.pop("Accuracy")[0], [[one[key] for key in ("name", "participants", "mean_accuracy", "deviation", "t_interval", "bootstrap_interval", "void")] for one in j["methods"]])
    rows, by_shape = of.pop("cross-section minus single-focus")
    order, wilcoxon = pair["order"], pair["wilcoxon"]

    def related(one):
        return f"r = {shown(one['r'])} ({p(one['p'])})"

    def mean(values):
        return sum(values) / len(values)

    def gain(quarters):  # of as many trials each
        return (quarters[2] + quarters[3] - quarters[0] - quarters[1]) / 2
    compare(rows, [
        ["participants with both methods", pair["participants"]], ["mean difference of accuracy", pair["mean"]],
        ["95 % (t)", pair["t_interval"]], ["95 % (bootstrap)", pair["bootstrap_interval"]],
        ["Hodges-Lehmann estimate", pair["hodges_lehmann"]], ["at least 95 % (Walsh averages)", pair["hodges_lehmann_interval"]],
        ["Cohen's d of the differences", pair["cohens_d"]],
        ["Wilcoxon's signed-rank test, exact", f"T+ = {wilcoxon['positive']}, T- = {wilcoxon['negative']}, {p(wilcoxon['p_two_sided'])}"],
        ["the same with Pratt's treatment of zeros", p(pair["wilcoxon_pratt"]["p_two_sided"])],
        ["correlation of the accuracies (Pearson)", related(pair["pearson"])], ["correlation of their ranks (Spearman)", related(pair["spearman"])],
        [f"mean difference of the {len(order['differences_a_first'])} who had single-focus before cross-section", mean(order["differences_a_first"])],
        [f"mean difference of the {len(order['differences_b_first'])} who had cross-section before single-focus", mean(order["differences_b_first"])],
        ["effect of the order (rank-sum test)", p(order["p"])]])
    compare_differences(by_shape, pair["tables"], shapes)
    for method in j["methods"]:
        for rows, wanted in zip(of.pop("Answers with " + method["name"]), measures(method, shapes), strict=True):
            compare(rows, wanted)
    compare(of.pop("Over the trials")[0], [
        [one["name"], gain(one["learning"]["block_accuracy"]), p(one["learning"]["gain_of_second_half"]["p_two_sided"]),
         *[one["answer_times"][key] for key in ("median_s", "correct_s", "wrong_s")]] for one in j["methods"]])
    compare(of.pop("Participants")[0], [
        [str(one["participant"]), one["method"], *[one[key] for key in ("turn", "trials", "void", "correct", "accuracy", "dprime", "bits", "answer_time_s")]]
        for one in j["participants"]])
    assert not of, "tables without a check"


def test_of_a_comparison(study):
    run(["study", "compare", "paper", str(study / "a.json"), "--quiet", "--html", str(study / "c.html"), "--json", str(study / "c.json")])
    j, tables = json.loads((study / "c.json").read_text()), [(heading, rows[1:]) for heading, rows in tables_of(study / "c.html")]
    for table in j["tables"]:
        for wanted in measures(table, table["shapes"]):
            heading, rows = tables.pop(0)
            assert heading == table["name"]
            compare(rows, wanted)
    for pair in j["pairs"]:
        heading, rows = tables.pop(0)
        assert heading == "Differences"
        compare_differences(rows, pair["tables"], j["tables"][0]["shapes"])
    assert not tables, "tables without a check"


def test_of_a_power(tmp_path):
    run(["study", "power", "--people", "6", "--studies", "100", "--quiet", "--html", str(tmp_path / "p.html"), "--json", str(tmp_path / "p.json")])
    j, ((_, rows),) = json.loads((tmp_path / "p.json").read_text()), tables_of(tmp_path / "p.html")
    compare(rows[1:], [[one[key] for key in ("participants", "power", "interval")] for one in j["rows"]])


PLAN = """[study]
participants = 3
trials_per_shape = 5
touch_s = 2
[observer]
depths_mm = [1]
placements = 3
lateral_mm = 0.05
yaw_deg = 0.5
[fit]
method = "cross-section"
accuracy = 0.6
trials = 30
[level]
ceiling = 0.04
[[shape]]
name = "one"
model = "palpa:cube.glb"
[[shape]]
name = "other"
model = "palpa:prism.glb"
[[method]]
name = "single-focus"
layout = "openmpd"
[[method]]
name = "cross-section"
layout = "openmpd"
foci = 4
"""


def test_of_a_simulation(tmp_path, bodies):
    bodies(tmp_path)
    (tmp_path / "plan.toml").write_text(PLAN)
    (tmp_path / "cross-section.csv").write_text("actual,one,other\none,9,1\nother,4,6\n")
    run(["study", "simulate", str(tmp_path / "plan.toml"), "--finger", str(tmp_path / "tip.ply"), "--beside", str(tmp_path / "cross-section.csv"), "--quiet",
         "--html", str(tmp_path / "o.html"), "--json", str(tmp_path / "o.json")])
    j, tables = json.loads((tmp_path / "o.json").read_text()), [(heading, rows[1:]) for heading, rows in tables_of(tmp_path / "o.html")]
    prediction, (beside,) = j["prediction"], j["beside"]
    shapes, plan = prediction["shapes"], prediction["plan_level"]

    def accuracies(name, one):
        return [name, one["what"], *([f"{method['accuracy']} ({shown(method['fitted_interval'])})" for method in one["methods"]] or ["-"] * 2)]
    compare(tables.pop(0)[1], [accuracies(one["name"], one) for one in prediction["variants"]]
            + [accuracies(f"level {one['name']}", one["prediction"]) for one in prediction["levels"]]
            + [accuracies(f"level plan ({1e3 * plan['crest_n']} mN), noise of the reference", plan["prediction"])]
            + [accuracies(f"null: {one['name']}", one) for one in prediction["nulls"]])
    for method in prediction["variants"][0]["methods"]:
        people_of = beside["counts"] if method["method"] == beside["method"] else None
        wanted = [[shape, *[f"{share} ({people_of[s][a] / sum(people_of[s])})" if people_of else share for a, share in enumerate(shares)]]
                  for s, (shape, shares) in enumerate(zip(shapes, method["shares"]))]
        compare(tables.pop(0)[1], wanted)
    heading, rows = tables.pop(0)
    assert heading == "Beside people"
    compare(rows, [[one["name"], one["rms"], one["errors_r"], one["log_likelihood"]] for one in beside["fits"]])
    studies = {one["method"]: one["accuracy"] for one in prediction["studies"]}
    compare(tables.pop(0)[1], [[one["method"], one["rank"], one["accuracy"], one["variants"], one["to_best"], one["spread"], studies[one["method"]]]
                               for one in prediction["ranking"]])
    assert not tables, "tables without a check"
