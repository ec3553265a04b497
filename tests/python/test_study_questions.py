"""A study's own questions: the tidy table, scales, yes and no, thresholds, checked against scipy and against simulated people
whose truth is known."""
import json
import math
import os
import re
import subprocess
import sys
import warnings

import numpy as np
import pytest
from scipy import special, stats

import study_folders as made
import commands
from commands import ROOT
from palpa import study
from palpa.study import __main__ as command
from palpa.study import statistics, table as tables, text

pandas = pytest.importorskip("pandas")
pytest.importorskip("matplotlib")
PALPA = os.path.abspath(commands.PALPA)
COLUMNS = ["participant", "run", "block", "trial", "condition", "method", "roughness", "roughness_time", "felt", "felt_time", "words", "words_time",
           "void", "played_share", "thinned_frames"]


def write_table(folder, rows, columns=COLUMNS, questions=None):
    """trials.tsv, as a study writes it."""
    folder.mkdir(exist_ok=True)
    lines = ["\t".join(columns)] + ["\t".join("n/a" if row.get(column) is None else str(row[column]) for column in columns) for row in rows]
    (folder / "trials.tsv").write_text("\n".join(lines) + "\n")
    if questions:
        (folder / "trials.json").write_text(json.dumps(questions))
    return folder


def roughness_rows(people=12, seed=1):
    """Three textures that feel ever rougher, catch trials, and a word."""
    random, rows = np.random.default_rng(seed), []
    for number in range(1, people + 1):
        bias = random.normal(0, 0.7)
        for trial, condition in enumerate(random.permutation(["fine", "medium", "coarse", "silent"] * 5), 1):
            rough = {"fine": 2.5, "medium": 3.5, "coarse": 5.5, "silent": 1}[condition]
            answer = int(np.clip(round(rough + bias + random.normal(0, 1)), 1, 7))
            felt = random.random() < {"silent": 0.15, "fine": 0.6}.get(condition, 0.9)
            rows.append({"participant": number, "run": 1, "block": "trial", "trial": trial, "condition": condition, "method": "cross-section",
                         "roughness": answer, "roughness_time": 1.5, "felt": "yes" if felt else "no", "felt_time": 0.5,
                         "words": "like sand, \"fine\"" if trial == 1 else None, "words_time": 3 if trial == 1 else None, "void": "false",
                         "played_share": 0.99, "thinned_frames": 0})
        rows.append(rows[-1] | {"trial": 21, "roughness": 7, "void": "true"})
    return rows


QUESTIONS = {"roughness": {"Kind": "scale", "Low": 1, "High": 7}, "felt": {"Kind": "yes-no"}, "words": {"Kind": "text"}}


@pytest.fixture
def rough(tmp_path):
    return write_table(tmp_path / "rough", roughness_rows(), questions=QUESTIONS)


# ---- the tidy table


def test_the_table_of_logs(tmp_path):
    made.voids(tmp_path / "voids")
    log = tmp_path / "voids/sub-1/beh/sub-1_task-shapes_run-01_events.tsv"
    lines = log.read_text().splitlines()
    more = "step\tskin_frames\toutdated_frames\tthinned_frames\tleft_out_frames"
    log.write_text("\n".join([f"{lines[0]}\t{more}"] + [f"{line}\t{number}\t200\t3\t4\t5" for number, line in enumerate(lines[1:], 1)]) + "\n")
    with pytest.warns(study.StudyWarning, match="was changed after"):
        table = study.load(tmp_path / "voids")
    assert list(table.columns[:12]) == ["participant", "run", "block", "trial", "condition", "method", "answer", "answer_time", "void", "played_share",
                                        "thinned_frames", "correct"]
    assert len(table.attrs["left_out"]) == 1 and table["void"].dtype == bool and table["participant"].dtype == "int64"
    first = table[(table["participant"] == 1) & (table["run"] == 1)]
    assert first["played_share"].eq(0.94).all() and first["thinned_frames"].eq(4).all() and list(first["trial"]) == list(range(1, len(first) + 1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = study.analyse(tmp_path / "voids")
    trials = table[(table["block"] == "trial") & ~table["void"]]
    for method in result["methods"]:
        own = trials[trials["method"] == method["name"]]
        assert method["trials"] == len(own) and method["correct"] == own["correct"].sum()
        assert method["void"] == (table["void"] & (table["block"] == "trial") & (table["method"] == method["name"])).sum()
        wanted = pandas.crosstab(own["condition"], own["answer"]).reindex(index=result["shapes"], columns=result["shapes"], fill_value=0)
        assert method["counts"] == wanted.to_numpy().tolist()
    assert "answers" not in result


def test_the_table_of_a_study(rough):
    table = study.load(rough)
    assert list(table.columns) == COLUMNS and len(table) == 252 and table["void"].sum() == 12
    assert table["roughness"].dtype == float and table["participant"].dtype == "int64"
    assert table["words"].dropna().iloc[0] == 'like sand, "fine"' and table["words"].notna().sum() == 12
    assert study.questions_of(table) == {"roughness": "scale", "felt": "yes-no", "words": "text"}
    plain = pandas.read_csv(rough / "trials.tsv", sep="\t")
    assert plain["roughness"].equals(table["roughness"].astype("int64"))


def test_rows_that_cannot_be_used_name_file_line_and_participant(tmp_path):
    rows = roughness_rows(2)
    folder = write_table(tmp_path / "broken", rows, questions=QUESTIONS)
    file = folder / "trials.tsv"
    lines = file.read_text().splitlines()
    lines[1] = lines[1].replace("\t1\ttrial\t1\t", "\t1\ttrial\tone\t")
    lines[2] = lines[2].rpartition("\t")[0]
    lines[3] = "x" + lines[3]
    lines[4] = lines[4].replace("false", "perhaps")
    lines[5] = lines[5].replace("0.99", "much")
    file.write_text("\ufeff" + "\r\n".join(lines))
    with pytest.warns(study.StudyWarning):
        table = study.load(folder)
    said = table.attrs["left_out"]
    assert len(said) == 6 and len(table) == len(rows) - 6
    for line, (number, who, what) in zip(said, [(2, "1", "trial 'one'"), (3, "1", "14 cells"), (4, "x1", "participant 'x1'"), (5, "1", "true or false"),
                                                (6, "1", "played_share 'much'"), (len(lines), "2", "no end")]):
        assert line.startswith(f"{file}: line {number}: participant {who}: ") and what in line and line.endswith("; the row is left out")
    file.write_text("participant\ttrial\n1\t2\n")
    with pytest.raises(study.BadInput, match="the column condition is missing"):
        study.load(folder)
    (folder / "trials.json").write_text('{"roughness": {"Kind": "smell"}}')
    write_table(folder, rows)
    with pytest.raises(study.BadInput, match='"Kind" of "roughness" is not scale'):
        study.load(folder)


def test_several_folders_have_different_people(tmp_path):
    one = write_table(tmp_path / "one", roughness_rows(2))
    other = write_table(tmp_path / "other", [row | {"participant": row["participant"] + 10} for row in roughness_rows(2)])
    assert sorted(study.load(one, other)["participant"].unique()) == [1, 2, 11, 12]
    with pytest.raises(study.BadInput, match="participant 1 is also in"):
        study.load(one, one)


# ---- scales


def test_scales_are_as_in_scipy(rough):
    table = study.load(rough)
    found = study.scales(table, "roughness")
    of_people = table[~table["void"]].groupby(["participant", "condition"])["roughness"].median().unstack()
    assert [one["group"] for one in found["groups"]] == ["coarse", "fine", "medium", "silent"]
    for one in found["groups"]:
        values = of_people[one["group"]]
        assert (one["median"], one["mean"]) == pytest.approx((values.median(), values.mean()), rel=1e-12)
        assert one["quartiles"] == pytest.approx(values.quantile([0.25, 0.75]).tolist(), rel=1e-12)
        assert one["t_interval"] == pytest.approx(stats.t.interval(0.95, 11, values.mean(), stats.sem(values)), rel=1e-9)
    chi_square, p = stats.friedmanchisquare(*(of_people[name] for name in of_people))
    assert (found["friedman"]["chi_square"], found["friedman"]["p"]) == pytest.approx((chi_square, p), rel=1e-9)
    assert len(found["pairs"]) == 6
    for pair in found["pairs"]:
        assert pair["wilcoxon"]["p_two_sided"] == pytest.approx(enumerated(of_people[pair["b"]] - of_people[pair["a"]]), rel=1e-12)
        assert pair["wilcoxon"]["p_two_sided"] <= pair["p_holm"] <= 1
    of_holm = [pair["p_holm"] for pair in found["pairs"]]
    assert min(of_holm) == pytest.approx(6 * min(pair["wilcoxon"]["p_two_sided"] for pair in found["pairs"]))


def enumerated(differences):
    """The exact two-sided p of Wilcoxon's test, by all signs of all differences."""
    kept = np.array([d for d in differences if d != 0])
    ranks = stats.rankdata(np.abs(kept))
    sums = np.array([0.0])
    for rank in ranks:
        sums = np.concatenate([sums, sums + rank])
    observed = ranks[kept > 0].sum()
    return min(1.0, 2 * min((sums >= observed - 1e-9).mean(), (sums <= observed + 1e-9).mean()))


def test_exact_tests_are_exact_with_ties_and_zeros():
    random = np.random.default_rng(3)
    for _ in range(30):
        differences = random.integers(-3, 4, random.integers(1, 12)).tolist()
        assert statistics.wilcoxon(differences)["p_two_sided"] == pytest.approx(enumerated(differences), rel=1e-12)
    # Zeros and ties, whose tests R and the literature have.
    mixed = [0, 0, 1, -1, 2, 2, -2, 3, 4, 5]
    drop, pratt = statistics.wilcoxon(mixed), statistics.wilcoxon(mixed, "pratt")
    assert (drop["positive"], drop["p_two_sided"], pratt["positive"], pratt["p_two_sided"]) == (30.5, 0.1015625, 42.5, 0.1171875)
    assert (drop["p_normal"], pratt["p_normal"]) == pytest.approx((0.07820880762, 0.0894208739), rel=1e-9)
    maize = [49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48]
    assert statistics.wilcoxon(maize)["p_two_sided"] == pytest.approx(0.04125976562, rel=1e-9)
    untied = random.normal(0.3, 1, 20).tolist()
    assert statistics.wilcoxon(untied)["p_two_sided"] == pytest.approx(stats.wilcoxon(untied, mode="exact").pvalue, rel=1e-9)
    a, b = random.normal(size=7).tolist(), random.normal(1, 1, 9).tolist()
    assert statistics.rank_sum(a, b)[1] == pytest.approx(stats.mannwhitneyu(a, b, method="exact").pvalue, rel=1e-9)
    x, y = random.normal(size=12).tolist(), random.normal(size=12).tolist()
    for ours, theirs in ((statistics.pearson, stats.pearsonr), (statistics.spearman, stats.spearmanr)):
        found, (r, p) = ours(x, y), theirs(x, y)
        assert (found["r"], found["p"]) == pytest.approx((r, p), rel=1e-9)


# ---- yes and no


def test_dprime_of_simulated_people(tmp_path):
    """People of known d' and criterion, with 40 trials: right on the mean within 0.1."""
    random = np.random.default_rng(11)
    for truth in (0.5, 1.0, 1.5, 2.0):
        rows, criteria = [], []
        for number in range(1, 401):
            criterion = random.normal(0.2, 0.2)
            criteria.append(criterion)
            for trial in range(40):
                signal = trial % 2 == 1
                yes = random.normal() + truth * signal > criterion + truth / 2
                rows.append({"participant": number, "trial": trial + 1, "condition": "tap" if signal else "silent", "felt": "yes" if yes else "no", "felt_time": 1})
        folder = write_table(tmp_path / f"{truth}", rows, ["participant", "trial", "condition", "felt", "felt_time"])
        tap = {one["group"]: one for one in study.yes_no(study.load(folder), "felt")["groups"]}["tap"]
        assert tap["dprime"] == pytest.approx(truth, abs=0.1)
        assert tap["criterion"] == pytest.approx(np.mean(criteria), abs=0.05)
        assert tap["participants"] == 400 and tap["trials"] == 8000


def test_dprime_of_a_table_by_hand(rough):
    table = study.load(rough)
    found = study.yes_no(table, "felt")
    own = table[(table["participant"] == 1) & ~table["void"]]
    hits, alarms = (int((own[own["condition"] == name]["felt"] == "yes").sum()) for name in ("fine", "silent"))
    one = next(group for group in found["groups"] if group["group"] == "fine")["people"][0]
    z = [stats.norm.ppf((count + 0.5) / 6) for count in (hits, alarms)]
    assert (one["dprime"], one["criterion"]) == pytest.approx((z[0] - z[1], -sum(z) / 2), rel=1e-12)
    assert "dprime" not in next(group for group in found["groups"] if group["group"] == "silent")


# ---- thresholds


def simulated(design, random, trials=40):
    """Levels and answers of one person, and the level at which they are right in three quarters of the trials."""
    position, width = random.uniform(4, 6), math.exp(random.normal(0, 0.3))

    def right(level):
        return random.random() < 0.5 + 0.48 * special.expit((level - position) / width)
    truth = position + width * special.logit(0.25 / 0.48)
    if design == "constant":
        levels = np.repeat(np.linspace(0, 10, 8), trials // 8)
        return levels, [right(level) for level in levels], truth
    level, step, streak, last, reversals, levels, answers = 10.0, 2.0, 0, 0, 0, [], []
    for _ in range(trials):
        levels.append(level)
        answers.append(right(level))
        streak = streak + 1 if answers[-1] else 0
        move = 0 if answers[-1] and streak < int(design[0]) else -1 if answers[-1] else 1
        if move:
            streak, reversals, last = 0, reversals + (last == -move), move
            level += move * (step if reversals < 2 else step / 2)
    return np.array(levels), answers, truth


def test_thresholds_of_simulated_people():
    """The bias of a threshold and how often its interval is right, of people with 40 trials: some each day, 4000 in the matrix."""
    people = 4000 if os.environ.get("PALPA_EXHAUSTIVE") else 100
    for design in ("constant", "2 down", "3 down"):
        random, errors, inside, truths = np.random.default_rng(7), [], 0, []
        for number in range(people):
            levels, answers, truth = simulated(design, random)
            found = study.fit(levels, answers, seed=number)
            errors.append(found["threshold"] - truth)
            truths.append(truth)
            inside += found["interval"][0] <= truth <= found["interval"][1]
        few = people < 4000
        noise = 2 * np.std(errors) / math.sqrt(people) / np.mean(truths) if few else 0
        assert abs(np.mean(errors) / np.mean(truths)) < 0.02 + noise, design
        assert 0.93 - 0.04 * few < inside / people < 0.97 + 0.04 * few, design


def test_a_threshold_of_many_trials_is_exact_and_its_function_fits():
    random = np.random.default_rng(2)
    levels = np.repeat(np.linspace(0, 10, 11), 2000)
    right = random.random(len(levels)) < 0.5 + 0.48 * special.expit((levels - 4.2) / 0.8)
    found = study.fit(levels, right)
    assert found["threshold"] == pytest.approx(4.2 + 0.8 * special.logit(0.25 / 0.48), abs=0.05)
    assert found["interval"][0] < found["threshold"] < found["interval"][1] and np.diff(found["interval"]) < 0.2
    assert study.right_at(found, found["threshold"]) == pytest.approx(0.75, abs=1e-9)
    assert study.fit(levels, right) == found, "the same seed, the same numbers"
    # Units do not matter.
    again = study.fit(1000 * levels + 7, right)
    assert again["threshold"] == pytest.approx(1000 * found["threshold"] + 7, rel=1e-9)


def test_thresholds_that_nobody_can_know():
    for levels, right in (([1, 1, 1], [True, False, True]), ([1, 2, 3], [True] * 3), ([1, 2], [False] * 2)):
        found = study.fit(levels, right)
        assert found["threshold"] is None and found["interval"] is None and found["trials"] == len(levels)
    with pytest.raises(ValueError, match="one number and one truth"):
        study.fit([1, math.nan], [True, False])


def staircase_rows(people=6):
    random, rows = np.random.default_rng(4), []
    for number in range(1, people + 1):
        levels, answers, _ = simulated("2 down", random)
        rows += [{"participant": number, "run": 1, "block": "pair", "trial": trial, "condition": "size", "method": "cross-section", "which": 1 + trial % 2,
                  "which_time": 1, "level": level, "correct": str(right).lower(), "void": "false"} for trial, (level, right) in enumerate(zip(levels, answers), 1)]
    return rows


# ---- reports


def test_a_report_of_ones_own_questions(rough, tmp_path, capsys):
    columns = ["participant", "run", "block", "trial", "condition", "method", "which", "which_time", "level", "correct", "void"]
    stairs = write_table(tmp_path / "stairs", staircase_rows(), columns, {"which": {"Kind": "pair"}})
    assert command.main(["analyse", str(rough), "--html", str(tmp_path / "a.html"), "--json", str(tmp_path / "a.json")]) == 0
    out = capsys.readouterr().out
    result, page = json.loads((tmp_path / "a.json").read_text()), (tmp_path / "a.html").read_text()
    assert [one["question"] for one in result["answers"]] == ["roughness", "felt", "words"]
    assert "like sand, &quot;fine&quot;" in page and page.count("<svg") == 2
    for one in result["answers"][0]["groups"]:
        assert f"{one['group']}: median {one['median']:.3f}, quartiles " in out
        assert f"<td>{one['median']:.3f}</td>" in page
    assert "Friedman" in page and "criterion" in page
    assert command.main(["analyse", str(stairs), "--html", str(tmp_path / "b.html"), "--json", str(tmp_path / "b.json"), "--quiet"]) == 0
    (threshold,) = json.loads((tmp_path / "b.json").read_text())["answers"]
    table = study.load(stairs)
    assert threshold["kind"] == "threshold" and len(threshold["groups"][0]["people"]) == 6
    assert 3 < threshold["groups"][0]["threshold"] < 7 and (tmp_path / "b.html").read_text().count("<svg") == 1
    assert threshold["groups"][0]["threshold"] == pytest.approx(study.thresholds(table, "which")["groups"][0]["threshold"], rel=1e-9)
    first, again = (study.analysis_page(study.analyse(stairs)).text() for _ in range(2))
    assert first == again == (tmp_path / "b.html").read_text()


def test_palpa_starts_python_for_questions_of_ones_own(rough, tmp_path):
    words = [PALPA, "study", "analyse", "rough", "--html", "a.html", "--script", "mine.py", "--quiet"]
    done = subprocess.run(words, cwd=tmp_path, env=os.environ | {"PALPA_PYTHON": sys.executable}, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert (tmp_path / "a.html").read_text() == study.analysis_page(study.analyse(rough)).text()
    (tmp_path / "mine.py").unlink()
    before = (rough / "trials.tsv").read_bytes()
    for output in ("rough/trials.tsv", "rough/trials.json", "rough/sub-1/x"):
        done = subprocess.run([*words, "--json", output], cwd=tmp_path, env=os.environ | {"PALPA_PYTHON": sys.executable}, capture_output=True, text=True,
                              timeout=120, check=False)
        assert done.returncode in (1, 2) and done.stderr.count("\n") == 1
    assert (rough / "trials.tsv").read_bytes() == before and not (tmp_path / "mine.py").exists()


def test_the_programs_of_the_page(tmp_path, monkeypatch):
    """docs/python/study.md, from a folder to a figure of one's own."""
    made.paper(tmp_path / "my-study")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs/python/study.md").read_text(), re.MULTILINE | re.DOTALL)
    assert len(blocks) == 2
    names = {}
    for block in blocks:
        exec(block, names)
    page = (tmp_path / "report.html").read_text()
    assert "<h2>By shape</h2>" in page and page.count("<svg") == 5 and names["page"]._repr_html_() in page
    assert names["shares"].loc["cube", "cross-section"] == pytest.approx(names["result"]["methods"][1]["recall"][0])


def test_names_of_the_package():
    assert set(study.__all__) <= set(dir(study)) and all(getattr(study, name) for name in study.__all__)
    with pytest.raises(AttributeError, match="no attribute 'analyze'"):
        study.analyze
    with pytest.raises(TypeError, match="power.. has no spreads: give accuracies"):
        study.power(spreads=1)
    with pytest.raises(KeyError, match="no question smell: it has"):
        study.scales(pandas.DataFrame({"void": [], "condition": []}), "smell")
    assert text.counted(2, "study") == "2 studies" and tables.KINDS[0] == "scale"
