"""Measures of confusion matrices and tests over participants. They are exact where C++ programs and R are, and where
scipy is not: the p of rank tests is that of the permutation distribution of the ranks that the data have, ties and zeros
included.

Results are dicts with the keys that `--json` writes.
"""
import collections
import functools
import math

import numpy as np
from scipy import special

MOST_EXACT_PAIRS, MOST_EXACT_PEOPLE = 200, 60

# ---- random numbers that are the same on every machine (SplitMix64)

GAMMA = 0x9e3779b97f4a7c15
WORD = 2 ** 64 - 1


def mixed(state):
    """The number of each state, an array of uint64."""
    z = (state ^ (state >> np.uint64(30))) * np.uint64(0xbf58476d1ce4e5b9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94d049bb133111eb)
    return z ^ (z >> np.uint64(31))


def draws(seed, steps):
    """The numbers of these steps (from 1) of the stream of a seed; `seed` may be an array."""
    return mixed(np.asarray(seed, np.uint64) + np.asarray(steps, np.uint64) * np.uint64(GAMMA))


def uniforms(numbers):
    """In (0, 1), never 0 or 1."""
    return ((numbers >> np.uint64(11)).astype(float) + 0.5) * 2.0 ** -53


# ---- samples


def mean(values):
    return sum(values, 0.0) / len(values) if len(values) else math.nan


def deviation(values):
    """With n - 1; None for fewer than two values."""
    if len(values) < 2:
        return None
    middle = mean(values)
    return math.sqrt(sum((value - middle) ** 2 for value in values) / (len(values) - 1))


def median(values):
    """None without values."""
    ordered, half = sorted(values), len(values) // 2
    if not ordered:
        return None
    return ordered[half] if len(ordered) % 2 else (ordered[half - 1] + ordered[half]) / 2


def t_interval(values):
    """Student's 95 % interval of the mean; None for fewer than two values."""
    spread = deviation(values)
    if spread is None:
        return None
    degrees, middle = len(values) - 1, mean(values)
    x = special.betaincinv(degrees / 2, 0.5, 0.05)
    half = float(math.sqrt(degrees * (1 - x) / x)) * spread / math.sqrt(len(values))
    return [middle - half, middle + half]


def cohens_d(values):
    """d_z of differences; None if the values do not differ."""
    spread = deviation(values)
    # Rounding leaves a deviation of some 1e-17 where all values are the same.
    return None if spread is None or spread < 1e-12 else mean(values) / spread


def resamples_for(count):
    """How often a sample of that size is resampled: 100,000 times, less often above 200 values."""
    return min(max(20_000_000 // max(count, 1), 2000), 100_000)


def bootstrap_interval(values, seed):
    """The 95 % percentile interval of the mean. Values must be one per person: resampling trials would pretend that all
    trials are independent. None for fewer than two values."""
    count = len(values)
    if count < 2:
        return None
    number, values = resamples_for(count), np.asarray(values, float)
    sums, first = np.zeros(number), np.arange(number, dtype=np.uint64) * np.uint64(count)
    for place in range(count):
        upper = draws(seed & WORD, first + np.uint64(place + 1)) >> np.uint64(32)
        sums += values[((upper * np.uint64(count)) >> np.uint64(32)).astype(np.intp)]
    means = np.sort(sums / count)
    return [float(means[math.floor(0.025 * (number - 1))]), float(means[math.ceil(0.975 * (number - 1))])]


def clopper_pearson(k, n):
    """The exact 95 % interval of a proportion."""
    low = 0.0 if k == 0 else float(special.betaincinv(k, n - k + 1, 0.025))
    return [low, 1.0 if k == n else float(special.betaincinv(k + 1, n - k, 0.975))]


def binomial_tail(k, n, p):
    """The probability of at least k of n."""
    return 1.0 if k == 0 else float(special.betainc(k, n - k + 1, p))


def chi_square_tail(value, degrees):
    return 1.0 if degrees <= 0 else float(special.gammaincc(degrees / 2, value / 2))


def normal_two_sided(z):
    return math.erfc(abs(z) / math.sqrt(2))


# ---- ranks


def midranks(values):
    """Ranks from 1, equal values with the mean of theirs; and the sum of t^3 - t over groups of equal values.

    Values are equal if they are the same double. Differences of counts must therefore be computed from whole numbers and
    divided once: 0.70 - 0.45 and 0.80 - 0.55 differ in their last bit."""
    before, ranks, ties = 0, {}, 0
    numbers = collections.Counter(values)
    for value in sorted(numbers):
        size = numbers[value]
        ranks[value] = (2 * before + size + 1) / 2
        ties += size ** 3 - size
        before += size
    return [ranks[value] for value in values], ties


def doubled(ranks):
    """Midranks are multiples of a half."""
    return [round(2 * rank) for rank in ranks]


@functools.lru_cache(maxsize=4096)
def sum_distribution(ranks):
    """The probability of each sum of a random subset of ranks, which are whole numbers."""
    probability = np.ones(1)
    for rank in ranks:
        # Halves instead of counts: 2^m would overflow, and a half of a double is exact.
        more = np.zeros(len(probability) + rank)
        more[:len(probability)] = probability / 2
        more[rank:] += probability / 2
        probability = more
    return probability


def wilcoxon(differences, zeros="drop"):
    """Wilcoxon's signed-rank test. Zeros are dropped before ranking ("drop"), or ranked and then dropped ("pratt")."""
    kept = [d for d in differences if d != 0 or zeros == "pratt"]
    ranks, ties = midranks([abs(d) for d in kept])
    used = [(rank, d) for rank, d in zip(ranks, kept) if d != 0]
    positive = sum((rank for rank, d in used if d > 0), 0.0)
    result = {"pairs": len(differences), "nonzero": len(used), "positive": positive,
              "negative": sum((rank for rank, d in used if d < 0), 0.0), "exact": True,
              "p_two_sided": 1.0, "p_greater": 1.0, "p_less": 1.0, "p_normal": 1.0, "p_normal_corrected": 1.0}
    if not used:
        return result
    n, zero = len(kept), len(kept) - len(used)
    middle, variance = n * (n + 1) / 4, n * (n + 1) * (2 * n + 1) / 24 - ties / 48
    if zeros == "pratt":
        middle -= zero * (zero + 1) / 4
        # The zeros are one group of ties, whose correction their own term replaces.
        variance += (zero ** 3 - zero) / 48 - zero * (zero + 1) * (2 * zero + 1) / 24
    spread, distance = math.sqrt(variance), positive - middle
    for key, correction in (("p_normal", 0), ("p_normal_corrected", 0.5)):
        result[key] = normal_two_sided(max(0.0, abs(distance) - correction) / spread) if spread > 0 else 1.0
    if len(used) > MOST_EXACT_PAIRS:
        result |= {"exact": False, "p_two_sided": result["p_normal"], "p_greater": float(special.ndtr(-distance / spread)),
                   "p_less": float(special.ndtr(distance / spread))}
        return result
    probability = sum_distribution(tuple(sorted(doubled(rank for rank, _ in used))))
    observed = round(2 * positive)
    # The smallest terms first, so that a small p keeps its digits.
    greater = min(1.0, float(np.cumsum(probability[:observed - 1 if observed else None:-1])[-1]))
    less = min(1.0, float(np.cumsum(probability[:observed + 1])[-1]))
    return result | {"p_greater": greater, "p_less": less, "p_two_sided": min(1.0, 2 * min(greater, less))}


def signed_rank_index(n, tail):
    """The largest k such that T+ of n untied differences is below k with a probability of at most `tail`: the k-th
    smallest and k-th largest Walsh average bound an interval of 1 - 2 tail. 0 if there is no such k."""
    if n == 0:
        return 0
    if n > MOST_EXACT_PAIRS:
        middle, spread = n * (n + 1) / 4, math.sqrt(n * (n + 1) * (2 * n + 1) / 24)
        return int(max(0.0, middle + float(special.ndtri(tail)) * spread))
    return int(np.searchsorted(np.cumsum(sum_distribution(tuple(range(1, n + 1)))), tail, side="right"))


def hodges_lehmann(differences):
    """The median of all Walsh averages, and an interval of at least 95 % (None for fewer than six differences)."""
    values = np.asarray(differences, float)
    i, j = np.triu_indices(len(values))
    walsh = np.sort((values[i] + values[j]) / 2)
    k = signed_rank_index(len(values), 0.025)
    return median(walsh.tolist()), [float(walsh[k - 1]), float(walsh[len(walsh) - k])] if k else None


def correlation_of(r, pairs):
    """p and interval of a Pearson correlation."""
    rest, n = 1 - r * r, pairs
    found = {"r": r, "p": 0.0, "interval": None}
    if rest > 0:
        t = r * math.sqrt((n - 2) / rest)
        found["p"] = float(special.betainc((n - 2) / 2, 0.5, (n - 2) / (n - 2 + t * t)))
        if n > 3:
            half = float(special.ndtri(0.975)) / math.sqrt(n - 3)
            found["interval"] = [math.tanh(math.atanh(r) - half), math.tanh(math.atanh(r) + half)]
    return found


def pearson(x, y):
    """None for fewer than three pairs, and if one of the samples does not vary."""
    n = len(x)
    if n < 3:
        return None
    x_mean, y_mean = mean(x), mean(y)
    xx, yy = sum((a - x_mean) ** 2 for a in x), sum((b - y_mean) ** 2 for b in y)
    if xx <= n * 1e-24 or yy <= n * 1e-24:
        return None
    xy = sum((a - x_mean) * (b - y_mean) for a, b in zip(x, y))
    return correlation_of(min(1.0, max(-1.0, xy / math.sqrt(xx * yy))), n)


def spearman(x, y):
    """Pearson's correlation of the ranks. If these agree or are reversed, p is the share of all orders in which they do."""
    (x, _), (y, _), n = midranks(x), midranks(y), len(x)
    found, same, reverse = pearson(x, y), x == y, [n + 1 - rank for rank in y]
    if found and (same or x == reverse):
        ordered, share = sorted(x), 1.0
        for i, rank in enumerate(ordered):
            share *= ordered[:i + 1].count(rank) / (i + 1)
        symmetric = all(a + b == n + 1 for a, b in zip(ordered, ordered[::-1]))
        found = {"r": 1.0 if same else -1.0, "p": 2 * share if symmetric else share, "interval": None}
    return found


def friedman(rows):
    """Whether the columns differ; each row is one person's values. Corrected for ties."""
    n, k, sums, ties = len(rows), len(rows[0]), [0.0] * len(rows[0]), 0
    for row in rows:
        ranks, tied = midranks(row)
        sums, ties = [a + b for a, b in zip(sums, ranks)], ties + tied
    found = {"participants": n, "chi_square": 0.0, "degrees": k - 1, "p": 1.0}
    scale = n * k * (k + 1) - ties / (k - 1)
    # Everybody's values are all equal: nothing differs.
    if scale > 0:
        found["chi_square"] = 12 * sum((one - n * (k + 1) / 2) ** 2 for one in sums) / scale
        found["p"] = chi_square_tail(found["chi_square"], k - 1)
    return found


def rank_sum(a, b):
    """Wilcoxon's rank-sum test of two groups: the sum of the ranks of `a`, and its two-sided p."""
    ranks, ties = midranks([*a, *b])
    total, n, m = sum(ranks[:len(a)], 0.0), len(ranks), len(a)
    if not a or not b:
        return total, 1.0
    if n > MOST_EXACT_PEOPLE:
        variance = m * (n - m) / 12 * (n + 1 - ties / (n * (n - 1)))
        return total, normal_two_sided((total - m * (n + 1) / 2) / math.sqrt(variance)) if variance > 0 else 1.0
    whole = doubled(ranks)
    ways = np.zeros((m + 1, sum(whole) + 1))
    ways[0, 0] = 1
    for rank in whole:
        ways[1:, rank:] += ways[:-1, :ways.shape[1] - rank].copy()
    share, observed = ways[m] / ways[m].sum(), round(2 * total)
    return total, min(1.0, 2 * min(float(share[observed:].sum()), float(share[:observed + 1].sum())))


def holm(p):
    """The p of several tests, corrected, in the same order."""
    corrected, largest = [0.0] * len(p), 0.0
    for place, i in enumerate(sorted(range(len(p)), key=lambda i: p[i])):
        largest = max(largest, min(1.0, p[i] * (len(p) - place)))
        corrected[i] = largest
    return corrected


# ---- confusion matrices


class Confusion:
    """How often each shape was answered (columns) for each actual shape (rows)."""

    def __init__(self, shapes, counts=None):
        self.shapes = list(shapes)
        self.counts = [list(row) for row in counts] if counts else [[0] * len(self.shapes) for _ in self.shapes]

    @property
    def rows(self):
        return [sum(row) for row in self.counts]

    @property
    def columns(self):
        return [sum(column) for column in zip(*self.counts)]

    @property
    def total(self):
        return sum(map(sum, self.counts))

    @property
    def correct(self):
        return sum(row[i] for i, row in enumerate(self.counts))

    @property
    def accuracy(self):
        """The quotient of two whole numbers: equal shares are equal doubles."""
        return self.correct / self.total if self.total else 0.0

    @property
    def shares(self):
        """By rows; 0 for shapes without trials."""
        return [[count / sum(row) if sum(row) else 0.0 for count in row] for row in self.counts]

    def in_order(self, shapes):
        place = {shape: i for i, shape in enumerate(self.shapes)}
        return Confusion(shapes, [[self.counts[place[a]][place[b]] for b in shapes] for a in shapes])


PAPER_SHAPES = ["cube", "semi-sphere", "pyramid", "prism"]
# The paper's Tables I and II, as counts of 100 trials per shape.
PAPER = {"single-focus": Confusion(PAPER_SHAPES, [[50, 30, 9, 11], [23, 42, 16, 19], [13, 37, 26, 24], [17, 18, 27, 38]]),
         "cross-section": Confusion(PAPER_SHAPES, [[74, 14, 2, 10], [5, 59, 11, 25], [2, 30, 65, 3], [14, 10, 13, 63]])}

# The trapezoidal rule: for a smooth function that vanishes at both ends, it is exact to rounding.
STEP = 0.06
GRID = -9 + STEP * np.arange(int(18 / STEP) + 1)
WEIGHTS = np.exp(-GRID ** 2 / 2) / math.sqrt(2 * math.pi) * STEP


def correct_of_dprime(dprime, alternatives):
    """The share of correct answers if one of m alternatives is shown and all are equally far apart."""
    return float(WEIGHTS @ special.ndtr(dprime + GRID) ** (alternatives - 1))


@functools.lru_cache(maxsize=4096)
def dprime(correct, trials, alternatives):
    """d' for m alternatives, all of them equally far apart. If all or no answers are correct, half a trial is assumed to
    be otherwise. None without trials."""
    if trials == 0 or alternatives < 2:
        return None
    share = min(max(correct / trials, 0.5 / trials), 1 - 0.5 / trials)
    low, high, middle = -10.0, 20.0, 0.0  # the secant method with a bracket (Illinois)
    at_low, at_high = correct_of_dprime(low, alternatives) - share, 1 - share
    for _ in range(200):
        if high - low <= 1e-13:
            break
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        here = correct_of_dprime(middle, alternatives) - share
        if abs(here) < 1e-15:
            break
        if here > 0:
            high, at_high, at_low = middle, here, at_low / 2
        else:
            low, at_low, at_high = middle, here, at_high / 2
    return middle


def dprime_of_hits(hits, signals, alarms, noises):
    """z(H) - z(F) with half a trial added to each of the four cells; None without signals or noises."""
    if signals == 0 or noises == 0:
        return None
    return float(special.ndtri((hits + 0.5) / (signals + 1)) - special.ndtri((alarms + 0.5) / (noises + 1)))


def dprime_of_pair(table, a, b):
    """d' of two shapes: of their rows, restricted to the answers a and b."""
    of_a, of_b = table.counts[a], table.counts[b]
    return dprime_of_hits(of_a[a], of_a[a] + of_a[b], of_b[a], of_b[a] + of_b[b])


def information(table):
    """What the answers tell about the shapes: transmitted information, corrected for the number of trials (Miller and
    Madow), and the most that perfect answers transmit, in bits; chi-square of independence."""
    found, n = {"bits": 0.0, "corrected_bits": 0.0, "most_bits": 0.0, "chi_square": 0.0}, table.total
    if n == 0:
        return found
    rows, columns, bits = table.rows, table.columns, 0.0
    found["most_bits"] = -sum(row / n * math.log2(row / n) for row in rows if row)
    for row, counts in zip(rows, table.counts):
        for column, count in zip(columns, counts):
            expected = row * column / n
            if expected == 0:
                continue
            if count:
                bits += count / n * math.log2(count / expected)
            found["chi_square"] += (count - expected) ** 2 / expected
    found["bits"] = max(0.0, bits)
    cells = (sum(map(bool, rows)) - 1) * (sum(map(bool, columns)) - 1)
    found["corrected_bits"] = found["bits"] - cells / (2 * n * math.log(2))
    return found


def fitted(table):
    """The expected cells of Luce's model, by iterative proportional fitting: each group of cells is scaled to its sum in
    the table, in turns, until nothing changes. The model is the same as quasi-symmetry, so its likelihood is largest where
    the sums of rows, of columns, and of each cell with its mirror image are the table's."""
    m = len(table.shapes)
    counts = [count for row in table.counts for count in row]
    groups = []
    for i in range(m):
        groups += [[i * m + j, j * m + i] for j in range(i + 1, m)]
        groups += [[i * m + j for j in range(m)], [j * m + i for j in range(m)], [i * m + i]]
    groups = [(group, sum(counts[cell] for cell in group)) for group in groups]
    cells = [1.0] * (m * m)
    for _ in range(20_000):
        change = 0.0
        for group, wanted in groups:
            now = 0.0
            for cell in group:
                now += cells[cell]
            factor = wanted / now if now > 0 else 0.0
            for cell in group:
                cells[cell] *= factor
            if now > 0 and abs(factor - 1) > change:
                change = abs(factor - 1)
        if change <= 1e-13:
            break
    return [cells[i * m:(i + 1) * m] for i in range(m)]


def luce_fit(table):
    """Luce's similarity choice model: the share of answers j for shape i is proportional to beta_j eta_ij. None if a shape
    has no trials or was never recognised, if some shapes are never confused with the others, and for fewer than 3 shapes."""
    m = len(table.shapes)
    if m < 3 or not all(table.rows) or not all(table.counts[i][i] for i in range(m)):
        return None
    cells, deviance, likelihood = fitted(table), 0.0, 0.0
    for row, total, expected in zip(table.counts, table.rows, cells):
        for count, cell in zip(row, expected):
            if count:
                deviance += 2 * count * math.log(count / cell)
                likelihood -= count * math.log(cell / total)
    similarity = [[1.0 if i == j else math.sqrt(cells[i][j] * cells[j][i] / (cells[i][i] * cells[j][j])) for j in range(m)] for i in range(m)]
    # From pair to pair: all pairs agree in cells that fit the model.
    bias, reached = [1.0] + [0.0] * (m - 1), [0]
    for i in reached:
        for j in range(m):
            if bias[j] == 0 and cells[i][j] > 0 and cells[j][i] > 0:
                bias[j] = bias[i] * math.sqrt(cells[i][j] * cells[j][j] / (cells[j][i] * cells[i][i]))
                reached.append(j)
    if len(reached) < m:
        return None
    degrees, deviance = (m - 1) * (m - 2) / 2, max(0.0, deviance)
    return {"similarity": similarity, "bias": [one / sum(bias) for one in bias], "deviance": deviance, "degrees": degrees,
            "p": chi_square_tail(deviance, degrees), "negative_log_likelihood": likelihood}


def measures(table):
    """All measures of one confusion matrix."""
    n, correct, m = table.total, table.correct, len(table.shapes)
    pairs = [(a, b) for a in range(m) for b in range(a + 1, m)]
    return {"trials": n, "correct": correct, "counts": table.counts, "accuracy": table.accuracy,
            "clopper_pearson": clopper_pearson(correct, n), "p_chance": binomial_tail(correct, n, 1 / m),
            "recall": [table.counts[i][i] / row if row else None for i, row in enumerate(table.rows)],
            "precision": [table.counts[i][i] / column if column else None for i, column in enumerate(table.columns)],
            "dprime": dprime(correct, n, m),
            "dprime_pairs": [{"a": table.shapes[a], "b": table.shapes[b], "dprime": dprime_of_pair(table, a, b)} for a, b in pairs],
            "luce_fit": luce_fit(table), "information": information(table)}


# ---- two tables


def rows_differ(a, b):
    """Whether two rows of counts have the same shares: chi-square and G2, and their degrees of freedom."""
    found = {"chi_square": 0.0, "likelihood_ratio": 0.0, "degrees": 0}
    sums = sum(a), sum(b)
    if not all(sums):
        return found
    found["degrees"] = sum(x + y > 0 for x, y in zip(a, b)) - 1
    for pair in zip(a, b):
        if sum(pair) == 0:
            continue
        for count, total in zip(pair, sums):
            expected = sum(pair) * total / sum(sums)
            found["chi_square"] += (count - expected) ** 2 / expected
            if count:
                found["likelihood_ratio"] += 2 * count * math.log(count / expected)
    return found


def with_p(difference):
    ratio = max(0.0, difference["likelihood_ratio"])
    return difference | {"likelihood_ratio": ratio, "p": chi_square_tail(difference["chi_square"], difference["degrees"]),
                         "p_likelihood_ratio": chi_square_tail(ratio, difference["degrees"])}


def two_tables(a, b):
    """How much two tables of the same shapes differ. The tests assume that all trials are independent; those of one person
    are not, so they only describe a difference."""
    rows = [rows_differ(one, other) for one, other in zip(a.counts, b.counts)]
    total = {key: sum(row[key] for row in rows) for key in ("chi_square", "likelihood_ratio", "degrees")}
    a_shares, b_shares = (np.array(table.shares) for table in (a, b))
    errors = ~np.eye(len(a.shapes), dtype=bool)
    correct = with_p(rows_differ([a.correct, a.total - a.correct], [b.correct, b.total - b.correct]))
    return {"rms": float(np.sqrt(np.mean((a_shares - b_shares) ** 2))),
            "errors": pearson(a_shares[errors].tolist(), b_shares[errors].tolist()), **with_p(total),
            "rows": [with_p(row) for row in rows], "correct": {key: correct[key] for key in ("chi_square", "p")}}
