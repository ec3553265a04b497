"""Results for people and programs: a few lines, tables as CSV, JSON, and one HTML page with figures. The same results give
the same bytes."""
import csv
import html
import io
import json
import math
import unicodedata

from .statistics import mean
from .text import CODING, brief, bytes_of, counted, printable, shortened

NO_VALUE = "-"  # stands for a value that does not exist
PAIR_NOTE = "All tests are two-sided and over participants."


# ---- numbers


def shown(value):
    """Three decimals; an interval as "0.217 to 0.308"; a correlation as "r = 0.867 (p = 0.00117)"."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return NO_VALUE
    if isinstance(value, dict):
        return f"r = {shown(value['r'])} ({shown_p(value['p'])})"
    if isinstance(value, (list, tuple)):
        return " to ".join(map(shown, value))
    # 0.6525 is a little less as a double, but people round it up.
    text = f"{value + math.copysign(1e-9, value):.3f}"
    return "0.000" if text == "-0.000" else text


def shown_p(p):
    return f"p = {p:.3g}"


def cell(value):
    """Of CSV: ten digits; names such that they cannot break the table."""
    if isinstance(value, str):
        return printable(value)
    return "" if value is None else value if isinstance(value, int) else f"{value:.10g}"


def table_of_csv(header, rows):
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([cell(value) for value in row] for row in rows)
    return out.getvalue()


def as_json(value):
    """The document as text: numbers with ten digits, because the last ones of a double depend on the C library; inner lists and dicts are one line each, if that is not too long."""
    def plain(one):
        if isinstance(one, dict):
            return {plain(key): plain(of_key) for key, of_key in one.items()}
        if isinstance(one, (list, tuple)):
            return [plain(of_list) for of_list in one]
        if isinstance(one, str):  # a name from a file may have any bytes; JSON may not
            return bytes_of(one).decode("utf-8", "replace")
        if isinstance(one, float):
            return float(f"{one:.10g}") if math.isfinite(one) else None
        return one

    def text(one, indent):
        line = json.dumps(one, ensure_ascii=False)
        if not isinstance(one, (dict, list)) or not one or (indent and len(line) + indent <= 120):
            return line
        space = " " * (indent + 2)
        parts = ([f"{json.dumps(key, ensure_ascii=False)}: {text(of_key, indent + 2)}" for key, of_key in one.items()]
                 if isinstance(one, dict) else [text(of_list, indent + 2) for of_list in one])
        ends = "{}" if isinstance(one, dict) else "[]"
        return ends[0] + "\n" + ",\n".join(space + part for part in parts) + "\n" + " " * indent + ends[1]
    return text(plain(value), 0) + "\n"


# ---- lines that several reports have


def void_text(result, method):
    return ", ".join(f"{printable(shape)} {count}" for shape, count in zip(result["shapes"], method["void_by_shape"]) if count)


def excluded_lines(result, pair):
    """Who is left out of a comparison, with the numbers of their trials."""
    if not pair["excluded"]:
        return []
    trials = {(one["participant"], one["method"]): one["trials"] for one in result["participants"]}
    people = ", ".join(f"participant {number} ({trials.get((number, pair['a']), 0)} and {trials.get((number, pair['b']), 0)})"
                       for number in pair["excluded"])
    lines = [f"left out, because the plan asks for at least {counted(result['least_trials'], 'trial')} with each method: {people}"]
    if "with_excluded" in pair:
        more = pair["with_excluded"]
        lines.append(f"with them: mean {shown(more['mean'])} of {counted(more['wilcoxon']['pairs'], 'participant')}, Wilcoxon's test "
                     f"{shown_p(more['wilcoxon']['p_two_sided'])}")
    return lines


def unfelt_lines(result):
    return [f"participant {one['participant']} felt nothing in {one['felt_nothing']} of {counted(one['asked'], 'familiarisation')}"
            for one in result["felt_nothing"] if one["felt_nothing"]]


def friedman_text(found):
    return f"chi-square {shown(found['chi_square'])} with {counted(found['degrees'], 'degree')} of freedom, {shown_p(found['p'])}"


def setting_line(power):
    a, b = power["accuracies"]
    return (f"accuracies {brief(a)} and {brief(b)}, {counted(power['trials'], 'trial')} each, spread {brief(power['spread'])} between "
            f"participants, correlation {brief(power['correlation'])}; test at {brief(power['alpha'])}; "
            f"{counted(power['studies'], 'study')}, seed {power['seed']}")


def answer_line(power):
    people = power["participants"]
    if people is None:
        return f"{counted(power['people'], 'participant')} {'does' if power['people'] == 1 else 'do'} not reach a power of {brief(power['power'])}"
    return f"{counted(people, 'participant')} {'reaches' if people == 1 else 'reach'} a power of {brief(power['power'])}"


def other_line(power, other):
    people = counted(other["participants"], "participant") if other["participants"] else f"more than {power['people']} participants"
    return f"with a correlation of {brief(other['correlation'])}: {people}"


WHY_OTHERS = ("The correlation is that of ten people, whose accuracies have the chance of their trials in them. Its 95 % interval is 0.27 "
              "to 0.94. At its ends:")


# ---- for a terminal


def padded(text, width, right=False):
    """As wide as that many letters of a terminal, of which some take two places."""
    space = " " * (width - sum(2 if unicodedata.east_asian_width(letter) in "WF" else 1 for letter in text))
    return space + text if right else text + space


def measures_text(table, shapes):
    name = max([6, *(min(len(bytes_of(printable(shape))), 24) for shape in shapes)])
    lines = ["  " + padded("actual", name) + "".join(" " + padded(shortened(printable(shape), 12), 12, True) for shape in shapes)]
    for shape, counts in zip(shapes, table["counts"]):
        shares = [shown(count / sum(counts) if sum(counts) else None) for count in counts]
        lines.append("  " + padded(shortened(printable(shape), 24), name) + "".join(f" {share:>12}" for share in shares))
    bits = table["information"]
    lines.append(f"  {table['correct']} of {table['trials']} correct: {shown(table['accuracy'])}, d' {shown(table['dprime'])}, "
                 f"{shown(bits['bits'])} of {shown(bits['most_bits'])} bit")
    return "\n".join(lines) + "\n"


def analysis_text(result):
    people = {one["participant"] for one in result["participants"]}
    text = f"{counted(len(people), 'participant')}, {len(result['shapes'])} shapes, {counted(len(result['methods']), 'method')}\n" if people else ""
    for method in result["methods"]:
        text += (f"\n{printable(method['name'])}: mean accuracy {shown(method['mean_accuracy'])} of "
                 f"{counted(method['participants'], 'participant')}, SD {shown(method['deviation'])}, 95 % {shown(method['t_interval'])}; "
                 f"{counted(method['void'], 'trial')} void\n")
        if voids := void_text(result, method):
            text += f"  void by shape, which is not chance: {voids}\n"
        text += measures_text(method, result["shapes"])
    for pair in result["pairs"]:
        names = f"\n{printable(pair['b'])} minus {printable(pair['a'])}: "
        if pair["participants"]:
            test = pair["wilcoxon"]
            text += names + f"mean {shown(pair['mean'])} (95 % {shown(pair['t_interval'])}) of {counted(pair['participants'], 'participant')}\n"
            text += (f"  Wilcoxon's signed-rank test, {'exact' if test['exact'] else 'approximate'}: {shown_p(test['p_two_sided'])}, "
                     f"T+ = {brief(test['positive'])}\n")
            if pair["p_holm"] is not None:
                text += f"  after Holm's correction for all pairs: {shown_p(pair['p_holm'])}\n"
            text += f"  correlation of the participants' accuracies: {shown(pair['pearson'])}\n"
        else:
            text += names + "nobody has enough trials\n"
        text += "".join(f"  {line}\n" for line in excluded_lines(result, pair))
    if result["friedman"]:
        text += f"\nFriedman's test of all methods: {friedman_text(result['friedman'])}\n"
    text += "".join(f"\n{line}\n" for line in unfelt_lines(result))
    text += "".join(f"\n{answers_text(answers)}" for answers in result.get("answers", ()))
    if result["left_out"]:
        text += f"\n{counted(len(result['left_out']), 'warning')} about files or rows, see above\n"
    return text


def answers_text(result):
    """One question of a study's own, by condition."""
    lines = [result["question"] + ":"]
    for one in result.get("groups", ()):
        value = (f"median {shown(one['median'])}, quartiles {shown(one['quartiles'])}" if result["kind"] == "scale" else
                 f"threshold {shown(one['threshold'])}, 95 % {shown(one['t_interval'])}" if result["kind"] == "threshold" else
                 f"yes {shown(one['mean_share'])}, d' {shown(one.get('dprime'))}, criterion {shown(one.get('criterion'))}" if result["kind"] == "yes-no" else
                 ", ".join(f"{printable(answer)} {count}" for answer, count in zip(result["answers"], one["counts"])))
        lines.append(f"  {printable(one['group'])}: {value}; {counted(one['participants'], 'participant')}")
    lines += [f"  participant {one['participant']}, {printable(one['group'])}: {printable(one['text'])}" for one in
              (result["answers"] if result["kind"] == "text" else ())]
    lines += [f"  {printable(one['b'])} minus {printable(one['a'])}: median {shown(one['median_difference'])}, {shown_p(one['wilcoxon']['p_two_sided'])} "
              f"(Holm: {shown_p(one['p_holm'])[4:]})" for one in result.get("pairs", ())]
    if result.get("friedman"):
        lines.append(f"  Friedman's test of all conditions: {friedman_text(result['friedman'])}")
    return "\n".join(lines) + "\n"


def comparison_text(result):
    parts = [f"{printable(table['name'])}: accuracy {shown(table['accuracy'])}, 95 % {shown(table['clopper_pearson'])}\n"
             + measures_text(table, table["shapes"]) for table in result["tables"]]
    parts += [f"{printable(pair['b'])} beside {printable(pair['a'])}:\n  rms difference {shown(pair['tables']['rms'])}, correlation of the "
              f"errors {shown(pair['tables']['errors'])}, G2 {shown(pair['tables']['likelihood_ratio'])} with "
              f"{counted(pair['tables']['degrees'], 'degree')} of freedom\n" for pair in result["pairs"]]
    return "\n".join(parts)


def power_text(power):
    text = setting_line(power) + "\n\n  participants   power   95 %\n"
    text += "".join(f"  {row['participants']:>12}   {shown(row['power'])}   {shown(row['interval'])}\n" for row in power["rows"])
    text += f"\n{answer_line(power)}\n"
    if power["other_correlations"]:
        text += WHY_OTHERS + "\n"
    return text + "".join(f"  {other_line(power, other)}\n" for other in power["other_correlations"])


# ---- CSV


def analysis_csv(result):
    keys = "participant method turn trials correct accuracy dprime bits answer_time_s void".split()
    return table_of_csv(keys, ([one[key] for key in keys] for one in result["participants"]))


def comparison_csv(result):
    return table_of_csv("name trials correct accuracy low high dprime bits".split(),
                        ([one["name"], one["trials"], one["correct"], one["accuracy"], *one["clopper_pearson"], one["dprime"],
                          one["information"]["bits"]] for one in result["tables"]))


def power_csv(power):
    return table_of_csv("participants found power low high".split(),
                        ([row["participants"], row["found"], row["power"], *row["interval"]] for row in power["rows"]))


# ---- HTML

STYLE = """body{font:15px/1.45 sans-serif;color:#111;background:#fff;max-width:60em;margin:2em auto;padding:0 1em}
h1{font-size:1.6em}h2{font-size:1.25em;margin-top:2em;border-bottom:1px solid #999}
table{border-collapse:collapse;margin:1em 0}caption,figcaption{text-align:left;font-size:.93em;color:#333;padding:.3em 0}
th,td{border:1px solid #aaa;padding:.2em .6em;text-align:right}th{background:#eee}th:first-child{text-align:left}
figure{margin:1em 0}svg{max-width:100%;height:auto}
@media print{body{font-size:10.5pt;max-width:none;margin:0}h2{break-after:avoid}figure,table{break-inside:avoid}
th{background:none}svg{print-color-adjust:exact;-webkit-print-color-adjust:exact}}
"""


def escaped(text):
    return html.escape(printable(text)).replace("&#x27;", "'")


class Page:
    """One HTML page that needs no network. A notebook shows it if it is the last value of a cell."""

    def __init__(self, title):
        self.title, self.parts = title, []

    def heading(self, words):
        self.parts.append(f"<h2>{escaped(words)}</h2>\n")

    def paragraph(self, words):
        self.parts.append(f"<p>{escaped(words)}</p>\n")

    def list(self, lines):
        if lines:
            self.parts.append("<ul>\n" + "".join(f"<li>{escaped(line)}</li>\n" for line in lines) + "</ul>\n")

    def table(self, caption, header, rows):
        text = "".join(f"<th>{escaped(name)}</th>" for name in header)
        lines = [f"<tr>{text}</tr>\n"]
        for row in rows:
            text = "".join(f"<{kind}>{escaped(str(value))}</{kind}>" for kind, value in zip(["th"] + ["td"] * len(row), row))
            lines.append(f"<tr>{text}</tr>\n")
        self.parts.append(f"<table>\n<caption>{escaped(caption)}</caption>\n{''.join(lines)}</table>\n")

    def figure(self, figure, caption, alternative=None):
        """A figure of matplotlib, with words for people who cannot see it."""
        from .figures import svg_of
        self.parts.append(f"<figure role=\"img\" aria-label=\"{escaped(alternative or caption)}\">\n{svg_of(figure, len(self.parts))}"
                          f"<figcaption>{escaped(caption)}</figcaption>\n</figure>\n")

    def _repr_html_(self):
        return "".join(self.parts)

    def text(self):
        return (f"<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{escaped(self.title)}</title>\n"
                f"<meta name=\"viewport\" content=\"width=device-width\">\n<style>\n{STYLE}</style>\n</head>\n<body>\n"
                f"<h1>{escaped(self.title)}</h1>\n{''.join(self.parts)}</body>\n</html>\n")

    def write(self, file):
        with open(file, "w", encoding=CODING[0], errors=CODING[1]) as out:
            out.write(self.text())


def add_measures(page, table, shapes):
    from . import figures
    name, luce, bits = table["name"], table["luce_fit"], table["information"]
    page.figure(figures.confusion(table, shapes), f"{name}: shares of the answers (columns) for each actual shape (rows). {table['correct']} of "
                f"{counted(table['trials'], 'trial')} {'is' if table['correct'] == 1 else 'are'} correct.", f"Confusion matrix of {name}")
    page.table("Recall is the share of a shape's trials that were answered correctly, precision the share of its answers that were correct. "
               "Bias is Luce's: the preference for an answer, whatever was shown.", ["shape", "trials", "recall", "precision", "bias"],
               [[shape, sum(table["counts"][i]), shown(table["recall"][i]), shown(table["precision"][i]), shown(luce and luce["bias"][i])]
                for i, shape in enumerate(shapes)])
    place = {shape: i for i, shape in enumerate(shapes)}
    page.table("How different two shapes feel. d' counts in standard deviations of the sensation's noise; 0 means that they cannot be told "
               "apart. Luce's similarity is 1 for shapes that feel the same and 0 for shapes that are never confused. Bias and similarity are "
               "those of the fit, which some tables do not have.", ["pair", "d'", "similarity"],
               [[f"{one['a']}, {one['b']}", shown(one["dprime"]), shown(luce and luce["similarity"][place[one["a"]]][place[one["b"]]])]
                for one in table["dprime_pairs"]])
    rows = [["accuracy", shown(table["accuracy"])], ["95 % interval (Clopper-Pearson)", shown(table["clopper_pearson"])],
            ["p of at least as many correct answers by chance", shown_p(table["p_chance"])], ["d' of all shapes", shown(table["dprime"])],
            ["transmitted information", f"{shown(bits['bits'])} of {shown(bits['most_bits'])} bit"],
            ["corrected for the number of trials", f"{shown(bits['corrected_bits'])} bit"]]
    if luce:
        rows.append(["fit of Luce's model", f"G2 = {shown(luce['deviance'])} with {counted(int(luce['degrees']), 'degree')} of freedom, {shown_p(luce['p'])}"])
    page.table("The interval and the tests of a table assume that all trials are independent. Trials of one participant are not, so they "
               "describe the table and do not replace the tests over participants.", ["measure", "value"], rows)


def add_difference(page, a, b, shapes, tables):
    rows = [[name, shown(one["chi_square"]), shown(one["likelihood_ratio"]), one["degrees"], f"{one['p']:.3g}"]
            for name, one in zip([*shapes, "all"], [*tables["rows"], tables])]
    page.table(f"{a} beside {b}: root mean square difference of the shares {shown(tables['rms'])}; correlation of the errors "
               f"{shown(tables['errors'])}. The tests assume that all trials are independent.",
               ["actual shape", "chi-square", "G2", "degrees of freedom", "p"], rows)


# ---- a study's own questions


def add_scale(page, result):
    from . import figures
    groups = result["groups"]
    page.figure(figures.by_condition({one["group"]: (one["median"], one["quartiles"]) for one in groups}, result["question"]),
                f"{result['question']}: medians over participants of each participant's median, and quartiles.")
    page.table("The median, quartiles and mean over participants of each participant's median.",
               ["condition", "participants", "median", "quartiles", "mean", "95 % (t)"],
               [[one["group"], one["participants"], *(shown(one[key]) for key in ("median", "quartiles", "mean", "t_interval"))] for one in groups])
    if result["friedman"]:
        page.paragraph(f"Friedman's test of all conditions over {counted(result['friedman']['participants'], 'participant')}: "
                       f"{friedman_text(result['friedman'])}.")
    if result["pairs"]:
        page.table("Wilcoxon's signed-rank test of each two conditions (the second minus the first), and its p after Holm's correction for all.",
                   ["conditions", "participants", "median difference", "p", "p (Holm)"],
                   [[f"{one['a']}, {one['b']}", one["participants"], shown(one["median_difference"]), f"{one['wilcoxon']['p_two_sided']:.3g}",
                     f"{one['p_holm']:.3g}"] for one in result["pairs"]])


def add_yes_no(page, result):
    from . import figures
    groups, with_dprime = result["groups"], [one for one in result["groups"] if one.get("t_interval")]
    if with_dprime:
        page.figure(figures.by_condition({one["group"]: (one["dprime"], one["t_interval"]) for one in with_dprime}, "d'"),
                    f"{result['question']}: d' beside {', '.join(result['noise'])}, with Student's 95 % interval over participants.")
    page.table(f"The share of yes, and d' and criterion beside {', '.join(result['noise'])}, as means over participants. With a criterion above 0, "
               "people say no more often.", ["condition", "participants", "trials", "yes", "d'", "95 % (t)", "criterion"],
               [[one["group"], one["participants"], one["trials"], shown(one["mean_share"]), shown(one.get("dprime")), shown(one.get("t_interval")),
                 shown(one.get("criterion"))] for one in groups])


def add_thresholds(page, result):
    from . import figures
    for group in result["groups"]:
        fits = {f"participant {one['participant']}": one for one in group["people"] if one["threshold"] is not None}
        if fits:
            page.figure(figures.psychometric(dict(list(fits.items())[:8]), "level"),
                        f"{result['question']}, {group['group']}: shares of right answers by level and the fitted functions"
                        + (" of the first eight participants." if len(fits) > 8 else "."))
        page.table(f"{group['group']}: the level at which {shown(result['share'])} of the answers are right, with a bootstrap interval of 95 %.",
                   ["participant", "trials", "threshold", "95 % (bootstrap)"],
                   [*([one["participant"], one["trials"], shown(one["threshold"]), shown(one["interval"])] for one in group["people"]),
                    ["mean", sum(one["trials"] for one in group["people"]), shown(group["threshold"]), shown(group["t_interval"])]])


def add_answers(page, result):
    """One question of answers_of()."""
    page.heading(result["question"])
    if result["kind"] in ANSWERS:
        ANSWERS[result["kind"]](page, result)
    elif result["kind"] == "text":
        page.table("What people wrote.", ["participant", "condition", "text"],
                   [[one["participant"], one["group"], one["text"]] for one in result["answers"]])
    else:
        page.table("How often each answer was given.", ["condition", "participants", *result["answers"]],
                   [[one["group"], one["participants"], *one["counts"]] for one in result["groups"]])


ANSWERS = {"scale": add_scale, "yes-no": add_yes_no, "threshold": add_thresholds}


# ---- pages


def add_left_out(page, lines):
    if lines:
        page.paragraph("Not everything could be analysed:")
        page.list(lines)


def add_pair(page, result, pair):
    a, b, order, test = pair["a"], pair["b"], pair["order"], pair["wilcoxon"]
    page.heading(f"{b} minus {a}")
    page.list(excluded_lines(result, pair))
    if not pair["participants"]:
        page.paragraph("Nobody has enough trials with both methods, so they are not compared.")
        return
    rows = [["participants with both methods", pair["participants"]], ["mean difference of accuracy", shown(pair["mean"])],
            ["95 % (t)", shown(pair["t_interval"])], ["95 % (bootstrap)", shown(pair["bootstrap_interval"])],
            ["Hodges-Lehmann estimate", shown(pair["hodges_lehmann"])],
            ["at least 95 % (Walsh averages)", shown(pair["hodges_lehmann_interval"])], ["Cohen's d of the differences", shown(pair["cohens_d"])],
            [f"Wilcoxon's signed-rank test, {'exact' if test['exact'] else 'normal approximation'}",
             f"T+ = {brief(test['positive'])}, T- = {brief(test['negative'])}, {shown_p(test['p_two_sided'])}"],
            ["the same with Pratt's treatment of zeros", shown_p(pair["wilcoxon_pratt"]["p_two_sided"])]]
    if pair["p_holm"] is not None:
        rows.append(["after Holm's correction for all pairs", shown_p(pair["p_holm"])])
    rows += [["correlation of the accuracies (Pearson)", shown(pair["pearson"])], ["correlation of their ranks (Spearman)", shown(pair["spearman"])]]
    if order["p"] is not None:
        for values, one, other in ((order["differences_a_first"], a, b), (order["differences_b_first"], b, a)):
            rows.append([f"mean difference of the {len(values)} who had {one} before {other}", shown(mean(values))])
        rows.append(["effect of the order (rank-sum test)", shown_p(order["p"])])
    page.table(PAIR_NOTE, ["measure", "value"], rows)
    add_difference(page, a, b, result["shapes"], pair["tables"])


def add_courses(page, result):
    from . import figures
    page.heading("Over the trials")
    page.figure(figures.learning(result), "Mean accuracy in each quarter of the trials with a method.")
    rows = []
    for method in result["methods"]:
        course, times = method["learning"], method["answer_times"]
        some = course["gain_of_second_half"]["pairs"] > 0
        rows.append([method["name"], shown(course["mean_gain"]), shown_p(course["gain_of_second_half"]["p_two_sided"]) if some else NO_VALUE,
                     shown(times["median_s"]), shown(times["correct_s"]), shown(times["wrong_s"])])
    page.table("Times are medians over participants of each participant's median.",
               ["method", "mean gain of the second half", "Wilcoxon", "answer time (s)", "if correct (s)", "if wrong (s)"], rows)
    for method in result["methods"]:
        if "depth" in method:
            page.figure(figures.depths(result, method), f"{method['name']}: mean depth of the finger below the top of the object, by time in the trial.")


def analysis_page(result):
    """The report of what analyse() returns."""
    page = Page("Which shape was it? Results of a study" if result["participants"] else "Results of a study")
    if result["participants"]:
        add_shapes(page, result)
    else:
        add_left_out(page, result["left_out"])
    for answers in result.get("answers", ()):
        add_answers(page, answers)
    return page


def add_shapes(page, result):
    """What people answered when they were asked which shape it was."""
    from . import figures
    people = {one["participant"] for one in result["participants"]}
    page.paragraph(f"{counted(len(people), 'participant')} answered which of {len(result['shapes'])} shapes they touched.")
    add_left_out(page, result["left_out"])
    page.heading("Accuracy")
    page.figure(figures.accuracy(result), "Accuracy of each participant with each method. The last group has the means; its bars show the standard "
                "deviation between participants.")
    page.table(f"The mean over participants and its 95 % intervals: Student's t, and a bootstrap over participants ({result['resamples']} "
               f"resamples, seed {result['seed']}).",
               ["method", "participants", "mean accuracy", "SD", "95 % (t)", "95 % (bootstrap)", "void trials"],
               [[one["name"], one["participants"], shown(one["mean_accuracy"]), shown(one["deviation"]), shown(one["t_interval"]),
                 shown(one["bootstrap_interval"]), one["void"]] for one in result["methods"]])
    page.list([f"{one['name']}: void trials by shape, which is not chance: {void_text(result, one)}" for one in result["methods"] if one["void_by_shape"]
               and any(one["void_by_shape"])])
    if found := result["friedman"]:
        page.paragraph(f"Friedman's test of all methods over {counted(found['participants'], 'participant')}: {friedman_text(found)}.")
    for pair in result["pairs"]:
        add_pair(page, result, pair)
    for method in result["methods"]:
        page.heading(f"Answers with {method['name']}")
        add_measures(page, method, result["shapes"])
    add_courses(page, result)
    page.heading("Participants")
    page.table("Turn 1 is the method with which the participant began. The information of few trials is too large.",
               ["participant", "method", "turn", "trials", "void", "correct", "accuracy", "d'", "bit", "answer time (s)"],
               [[one["participant"], one["method"], one["turn"], one["trials"], one["void"], one["correct"],
                 *(shown(one[key]) for key in ("accuracy", "dprime", "bits", "answer_time_s"))] for one in result["participants"]])
    page.list(unfelt_lines(result))


def comparison_page(result):
    """The report of what compare() returns."""
    from . import figures
    page = Page("Which shape was it? Results beside each other")
    add_left_out(page, result["left_out"])
    page.figure(figures.accuracies(result["tables"]),
                "Accuracies with 95 % intervals (Clopper-Pearson). The intervals assume that all trials are independent.")
    for table in result["tables"]:
        page.heading(table["name"])
        add_measures(page, table, table["shapes"])
    if result["pairs"]:
        page.heading("Differences")
    shapes = {table["name"]: table["shapes"] for table in result["tables"]}
    for pair in result["pairs"]:
        add_difference(page, pair["a"], pair["b"], shapes[pair["a"]], pair["tables"])
    return page


def power_page(power):
    """The report of what power() returns."""
    from . import figures
    page = Page("How many participants?")
    page.paragraph(answer_line(power) + ".")
    page.paragraph("Simulated: " + setting_line(power) + ".")
    if power["other_correlations"]:
        page.paragraph(WHY_OTHERS)
        page.list([other_line(power, other) for other in power["other_correlations"]])
    page.figure(figures.power(power), "The share of simulated studies in which Wilcoxon's exact signed-rank test finds the difference, with its 95 % interval.")
    page.table("Power by number of participants.", ["participants", "power", "95 %"],
               [[row["participants"], shown(row["power"]), shown(row["interval"])] for row in power["rows"]])
    return page
