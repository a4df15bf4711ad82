"""A study's tables by their definitions, with NumPy alone and none of PinPose's code: what `pinpose report` has to find.

    python3 report.py FOLDER MARGIN_PERCENT MARGIN_DEG SEED

FOLDER holds results/*.json, truth.json and the meshes (OBJ) in assets/. Prints {table: rows}; a mean with its deviation and an
interval are lists of two.
"""

import hashlib
import json
import math
import pathlib
import sys
from collections import defaultdict

import numpy as np

FOLDER = pathlib.Path(sys.argv[1])
MARGIN_PERCENT, MARGIN_DEG, SEED = float(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4])
ALL = ["rotation", "translation", "add", "share", "depth", "rotation_sym", "ad", "mssd"]
BETWEEN = [name for name in ALL if name not in ("depth", "ad")]
KINDS = [("best 90 %", True), ("100 %", False)]


# Poses and meshes


def pose_of(record):
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = record["R"], record["t"]
    return pose


def moved(vertices, pose):
    return vertices @ pose[:3, :3].T + pose[:3, 3]


def angle_deg(a, b):
    relative = a[:3, :3].T @ b[:3, :3]
    skew = relative - relative.T
    sine = np.linalg.norm([skew[2, 1], skew[0, 2], skew[1, 0]]) / 2
    return np.degrees(np.arctan2(sine, (np.trace(relative) - 1) / 2))


def rotation_vector_deg(rotation):
    skew = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]) / 2
    sine = np.linalg.norm(skew)
    return np.degrees(np.arctan2(sine, (np.trace(rotation) - 1) / 2)) * skew / sine


def read_vertices(sha256):
    for path in (FOLDER / "assets").iterdir():
        if hashlib.sha256(path.read_bytes()).hexdigest() == sha256:
            lines = [line.split() for line in path.read_text().splitlines()]
            return np.array([words[1:4] for words in lines if words[:1] == ["v"]], dtype=float)
    raise FileNotFoundError(sha256)


class Sample:
    def __init__(self, record, label):
        self.label, self.set, self.name = label, record["set"], f"{record['object']} in {record['photo']}"
        self.vertices = read_vertices(record["mesh_sha256"])
        self.truth = pose_of(record["pose"])
        self.symmetries = [np.eye(4)] + [pose_of(entry) for entry in record.get("symmetries", {}).get("discrete", [])]
        gaps = self.vertices[:, None] - self.vertices[None]
        self.diameter = np.linalg.norm(gaps, axis=2).max()
        self.middle = (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2

    def difference(self, pose, reference):
        at, expected = moved(self.vertices, pose), moved(self.vertices, reference)
        add = np.linalg.norm(at - expected, axis=1).mean()
        nearest = np.linalg.norm(expected[:, None] - at[None], axis=2).min(axis=1).mean()
        twins = [reference @ symmetry for symmetry in self.symmetries]
        return {
            "rotation": angle_deg(pose, reference),
            "translation": np.linalg.norm(pose[:3, 3] - reference[:3, 3]),
            "add": add,
            "share": 100 * add / self.diameter,
            "depth": (moved(self.middle, pose) - moved(self.middle, reference))[2],
            "rotation_sym": min(angle_deg(pose, twin) for twin in twins),
            "ad": nearest if len(twins) > 1 else add,
            "mssd": min(np.linalg.norm(at - moved(self.vertices, twin), axis=1).max() for twin in twins),
        }

    def offsets(self, pose):
        twin = min((self.truth @ symmetry for symmetry in self.symmetries), key=lambda twin: angle_deg(pose, twin))
        moved_by = (moved(self.middle, pose) - moved(self.middle, twin)) * 100 / self.diameter
        return np.concatenate([moved_by, rotation_vector_deg(pose[:3, :3] @ twin[:3, :3].T)])


# Statistics


def spread(values):
    return [np.mean(values), np.std(values)] if len(values) else None


def spreads(rows, names):
    return [spread([row[name] for row in rows]) for name in names]


def student_tail(t, freedom):
    """P(T > t) for a whole number of degrees of freedom (Abramowitz and Stegun, 26.7.3 and 26.7.4)."""
    theta = math.atan(abs(t) / math.sqrt(freedom))
    sine, cosine = math.sin(theta), math.cos(theta)
    if freedom % 2:
        term, total = cosine, cosine if freedom > 1 else 0.0
        for k in range(3, freedom - 1, 2):
            term *= cosine**2 * (k - 1) / k
            total += term
        inside = 2 / math.pi * (theta + sine * total)
    else:
        term = total = 1.0
        for k in range(2, freedom - 1, 2):
            term *= cosine**2 * (k - 1) / k
            total += term
        inside = sine * total
    return (1 - inside) / 2 if t > 0 else (1 + inside) / 2


def student_quantile(part, freedom):
    low, high = 0.0, 1e3
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if 1 - student_tail(middle, freedom) < part else (low, middle)
    return (low + high) / 2


class Chance:
    """SplitMix64, the fair remainder below a count."""

    def __init__(self, seed):
        self.state = seed

    def next(self):
        mask = (1 << 64) - 1
        self.state = (self.state + 0x9E3779B97F4A7C15) & mask
        mixed = ((self.state ^ (self.state >> 30)) * 0xBF58476D1CE4E5B9) & mask
        mixed = ((mixed ^ (mixed >> 27)) * 0x94D049BB133111EB) & mask
        return mixed ^ (mixed >> 31)

    def below(self, count):
        top = (1 << 64) - 1
        fair = top - top % count
        while True:
            drawn = self.next()
            if drawn < fair:
                return drawn % count


def bootstrap(groups):
    """The 95 % interval of the first group's mean less the second's, where there is one."""
    chance, found = Chance(SEED), []
    for _ in range(10_000):
        means = [sum(group[chance.below(len(group))] for _ in group) / len(group) for group in groups]
        found.append(means[0] - means[1] if len(means) == 2 else means[0])
    return [np.percentile(found, 2.5), np.percentile(found, 97.5)]


def lowest(rows):
    """The floor(0.9 n) rows with the lowest ADD."""
    order = sorted(range(len(rows)), key=lambda at: rows[at]["add"])
    return [rows[at] for at in sorted(order[: len(rows) * 9 // 10])]


# Reading


truth = json.loads((FOLDER / "truth.json").read_text())
sets = list(dict.fromkeys(record["set"] for record in truth["samples"]))
samples, places = {}, defaultdict(int)
for record in truth["samples"]:
    samples[record["id"]] = Sample(record, f"S{places[record['set']]}")
    places[record["set"]] += 1
results = [json.loads(path.read_text()) for path in sorted((FOLDER / "results").iterdir())]
results.sort(key=lambda one: one["started_at"])
results.sort(key=lambda one: sets.index(one["trials"][0]["set"]))
conditions = list(dict.fromkeys(trial["condition"] for one in sorted(results, key=lambda one: one["started_at"]) for trial in one["trials"]))
people, places = [], defaultdict(int)
for one in results:
    own = one["trials"][0]["set"]
    people.append({"label": f"{own[0]}{places[own]}", "set": own, "file": one, "condition": one["trials"][0]["condition"]})
    places[own] += 1

trials, pairs = [], []
for person in people:
    by_sample = defaultdict(list)
    for trial in person["file"]["trials"]:
        sample = samples[trial["sample"]]
        pose = pose_of(trial["final_pose"])
        row = sample.difference(pose, sample.truth)
        row.update(person=person["label"], sample=sample, pose=pose, seconds=trial["time_s"], repeat=trial["repeat"], condition=trial["condition"], best=False, kept=False, key=trial["sample"])
        trials.append(row)
        by_sample[trial["sample"]].append(row)
    for key in sorted(by_sample, key=list(samples).index):
        rows = sorted(by_sample[key], key=lambda row: row["repeat"])
        min(rows, key=lambda row: row["add"])["best"] = True
        for i, first in enumerate(rows):
            for second in rows[i + 1 :]:
                pair = first["sample"].difference(second["pose"], first["pose"])
                pair.update(person=person["label"], sample=first["sample"], condition=first["condition"], repeats=[first["repeat"], second["repeat"]], kept=False)
                pairs.append(pair)
for name in sets:
    for row in lowest([row for row in trials if row["best"] and row["sample"].set == name]):
        row["kept"] = True
for person in people:
    for row in lowest([row for row in pairs if row["person"] == person["label"]]):
        row["kept"] = True


def best(kept, **wanted):
    return [row for row in trials if row["best"] and (row["kept"] or not kept) and all(matches(row, *item) for item in wanted.items())]


def matches(row, key, value):
    return (row["sample"].set if key == "set" else row["sample"].label if key == "label" else row[key]) == value


def pairs_of(person, kept):
    return [row for row in pairs if row["person"] == person["label"] and (row["kept"] or not kept)]


agreement = []
for key in samples:
    for condition in conditions:
        rows = [row for row in trials if row["best"] and row["key"] == key and row["condition"] == condition]
        for step in range(1, len(rows)):
            # The same pairs as on a ring: each pair once, the earlier person first.
            for i in range(len(rows) - step):
                pair = rows[i]["sample"].difference(rows[i + step]["pose"], rows[i]["pose"])
                pair.update(persons=[rows[i]["person"], rows[i + step]["person"]], sample=rows[i]["sample"], condition=condition)
                agreement.append(pair)


# Tables


def members(name):
    return [person for person in people if person["set"] == name]


tables = defaultdict(list)
for name in sets:
    for label, kept in KINDS:
        rows = best(kept, set=name)
        tables["inter-personal"].append([name, label, len(rows), *spreads(rows, ALL)])
        means = {measure: [np.mean([row[measure] for row in pairs_of(person, kept)]) for person in members(name)] for measure in BETWEEN}
        tables["intra-personal"].append([name, label, len(members(name)), *(spread(means[measure]) for measure in BETWEEN)])
        for measure, unit, title in zip(ALL, ["deg", "mm", "mm", "%", "mm", "deg", "mm", "mm"], ["rotation", "translation", "ADD", "ADD of diameter", "depth", "rotation (sym.)", "AD", "MSSD"]):
            values = [row[measure] for row in rows]
            quartiles = [np.percentile(values, part) for part in (50, 25, 75, 90)]
            tables["inter-distributions"].append([name, label, title, unit, len(values), np.mean(values), np.std(values), *quartiles, max(values)])
    for sample in [sample for sample in samples.values() if sample.set == name]:
        for label, kept in KINDS:
            rows = best(kept, set=name, label=sample.label)
            tables["inter-by-sample"].append([name, sample.label, sample.name, label, sample.diameter, len(rows), *spreads(rows, ALL)])
    for person in members(name):
        for label, kept in KINDS:
            rows = best(kept, person=person["label"])
            tables["inter-by-person"].append([name, person["label"], label, len(rows), *spreads(rows, ALL)])
            rows = pairs_of(person, kept)
            tables["intra-by-person"].append([name, person["label"], label, len(rows), *spreads(rows, BETWEEN)])
    rows = [row for row in agreement if row["sample"].set == name]
    tables["agreement"].append([name, "all", len(rows), *spreads(rows, BETWEEN)])
    for sample in [sample for sample in samples.values() if sample.set == name]:
        rows = [row for row in agreement if row["sample"] is sample]
        tables["agreement"].append([name, sample.label, len(rows), *spreads(rows, BETWEEN)])

# Times


def seconds(person):
    return [row["seconds"] for row in trials if row["person"] == person["label"]]


for person in people:
    tables["times"].append([person["set"], person["label"], len(seconds(person)), spread(seconds(person)), np.median(seconds(person))])
groups = [(name, members(name)) for name in sets] + ([("all sets", people)] if len(sets) > 1 else [])
for name, group in groups:
    means = [np.mean(seconds(person)) for person in group]
    tables["times"].append([name, "persons' means", len(means), spread(means), np.median(means)])

# Equivalence

OFFSETS = ["offset to the right", "offset downwards", "offset away from the camera"] + [f"rotation about the camera's {axis}" for axis in "xyz"]


def tested(values, margin, both):
    n, mean = len(values), np.mean(values)
    error = np.std(values, ddof=1) / math.sqrt(n)
    p = student_tail((margin - mean) / error, n - 1)
    if both:
        p = max(p, student_tail((mean + margin) / error, n - 1))
    reach = student_quantile(0.95, n - 1) * error
    return n, mean, [mean - reach, mean + reach], p


for name in sets:
    own = lambda person: [row for row in trials if row["person"] == person["label"]]
    offsets = np.array([np.mean([row["sample"].offsets(row["pose"]) for row in own(person)], axis=0) for person in members(name)])
    for at, title in enumerate(OFFSETS):
        margin, unit = (MARGIN_PERCENT, "% of diameter") if at < 3 else (MARGIN_DEG, "°")
        n, mean, interval, p = tested(offsets[:, at], margin, True)
        tables["equivalence"].append([name, title, unit, n, mean, interval, f"±{margin:g}", p, "yes" if p < 0.05 else "no"])
    shares = [np.mean([100 * row["ad"] / row["sample"].diameter for row in own(person)]) for person in members(name)]
    n, mean, interval, p = tested(shares, MARGIN_PERCENT, False)
    tables["equivalence"].append([name, "AD, one-sided", "% of diameter", n, mean, interval, f"below {MARGIN_PERCENT:g}", p, "yes" if p < 0.05 else "no"])

# Questionnaires

SCALES = ["mental", "physical", "temporal", "performance", "effort", "frustration"]
for person in people:
    for asked in person["file"]["questionnaires"]:
        answers = {answer["item"]: answer["value"] for answer in asked["answers"]}
        if asked["kind"] == "nasa_tlx":
            ratings = [answers[scale] for scale in SCALES]
            chosen = [sum(pair["chosen"] == scale for pair in asked["pairs"]) for scale in SCALES]
            weighted = np.dot(ratings, chosen) / 15 if asked["pairs"] else None
            person["tlx"] = np.mean(ratings)
            tables["nasa-tlx"].append([person["label"], *ratings, np.mean(ratings), weighted])
        if asked["kind"] == "sus":
            given = [answers.get(f"sus{at}") for at in range(1, 11)]
            filled = [3 if answer is None else answer for answer in given]
            adjusted = [answer if at % 2 == 0 else 6 - answer for at, answer in enumerate(filled)]
            person["sus"] = 2.5 * (sum(x - 1 for x in filled[::2]) + sum(5 - x for x in filled[1::2]))
            tables["sus"].append([person["label"], *adjusted, person["sus"], sum(answer is None for answer in given)])
for name in ("nasa-tlx", "sus"):
    columns = [[row[at] for row in tables[name] if row[at] is not None] for at in range(1, len(tables[name][0]))]
    tables[name].append(["mean", *map(spread, columns)])

# Conditions and answers

QUANTITIES = ["time (s)", "rotation (°)", "translation (mm)", "ADD (mm)", "AD (mm)", "ADD of repeats (mm)", "TLX raw", "SUS"]


def quantities(person):
    rows = best(False, person=person["label"])
    errors = [np.mean([row[name] for row in rows]) for name in ("rotation", "translation", "add", "ad")]
    repeats = np.mean([row["add"] for row in pairs_of(person, False)])
    return [np.mean(seconds(person)), *errors, repeats, person["tlx"], person["sus"]]


numbers = {person["label"]: quantities(person) for person in people}


def over(group):
    return [spread([numbers[person["label"]][at] for person in group]) for at in range(len(QUANTITIES))]


by_condition = [[person for person in people if person["condition"] == condition] for condition in conditions]
for condition, group in zip(conditions, by_condition):
    tables["conditions"].append([condition, len(group), *over(group)])
for i, first in enumerate(by_condition):
    for j in range(i + 1, len(by_condition)):
        for at, title in enumerate(QUANTITIES):
            groups = [[numbers[person["label"]][at] for person in group] for group in (first, by_condition[j])]
            difference = np.mean(groups[0]) - np.mean(groups[1])
            tables["condition-differences"].append([f"{conditions[i]} − {conditions[j]}", title, "between persons", len(groups[0]), len(groups[1]), difference, bootstrap(groups)])
answers = {person["label"]: person["file"]["items_before"][0]["value"] for person in people}
for answer in sorted(set(answers.values())):
    group = [person for person in people if answers[person["label"]] == answer]
    tables["by-answer-1"].append([answer, len(group), *over(group)])

# Every number

ids = {person["label"]: person["file"]["participant"]["id"] for person in people}
simulated = {person["label"]: int(person["file"]["is_simulated"]) for person in people}


def named(row, person):
    sample = row["sample"]
    return [sample.set, person, ids[person], simulated[person], row["condition"], sample.label, sample.name]


for row in trials:
    flags = [0, int(row["best"]), int(row["kept"])]
    tables["trials"].append([*named(row, row["person"]), row["repeat"] + 1, row["seconds"], *flags, *(row[name] for name in ALL)])
for row in pairs:
    tables["pairs"].append([*named(row, row["person"]), *(repeat + 1 for repeat in row["repeats"]), int(row["kept"]), *(row[name] for name in BETWEEN)])
for row in agreement:
    tables["agreement-pairs"].append([*named(row, row["persons"][0]), row["persons"][1], *(row[name] for name in BETWEEN)])

print(json.dumps(tables, default=float))
