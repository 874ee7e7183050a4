#!/usr/bin/env python3
"""Is what stands inside a matte found? Guesses of what to hold beside hand-drawn ones (holds.toml).

usage: holds.py MATTES [--guesses FOLDER] [--holds FILE] [--sheets FOLDER] [--weights FILE] [--draw FOLDER] [--clicks]

MATTES holds NAME_still.png and NAME_matte.png of 640 px, as first_takes.py leaves them; FOLDER NAME_hold.png, white where the guess
holds (none: nothing is held). Prints for each picture what share of its matte is drawn as standing; how much of that is found; and
how much of the fluid is taken. Then the same over all pixels, and as a mean over pictures: of the set, and of the pictures held out,
which no constant may be set by.
--weights writes vision/look/standing_weights.h, learned from the set alone by the NAME.figures of `bench_holds --figures` in --guesses.
--draw writes what is drawn, for `bench_holds --drawn`; --clicks prints what is held after how many clicks of one who does nothing else.
Sheets, for the eye: found green, missed red, taken from the fluid yellow, the matte's outline white.
"""
import argparse
import hashlib
import pathlib
import re
import tomllib

import cv2
import numpy

FARTHEST = 4  # deviations that a figure counts
MOST_TAKEN = .045
CLICKS = (0, 1, 2, 3, 5, 8, 12)  # as holds.cc has them
STARTS = ("plain_none", "plain_auto", "sized_none", "sized_auto")


def held_out(names):
    """The half whose names' SHA-256 are lowest: a lot that nobody chose."""
    return set(sorted(names, key=lambda name: hashlib.sha256(name.encode()).hexdigest())[:len(names) // 2])


def drawn(size, hold):
    mask = numpy.zeros(size, numpy.uint8)
    for area in hold.get("areas", []):
        cv2.fillPoly(mask, [numpy.int32(area)], 255)
    for x, y, radius in hold.get("discs", []):
        cv2.circle(mask, (x, y), radius, 255, -1)
    return mask > 127


def sheet(still, matte, truth, guess):
    shown = still.copy()
    for where, colour in ((truth & guess, (0, 200, 0)), (truth & ~guess, (0, 0, 255)), (guess & ~truth, (0, 230, 255))):
        shown[matte & where] = .5 * shown[matte & where] + .5 * numpy.array(colour)
    outlines = cv2.findContours(matte.astype(numpy.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)[0]
    cv2.drawContours(shown, outlines, -1, (255, 255, 255), 1)
    return shown


def counted(matte, truth, guess):
    """Of the matte, in pixels: what stands, what is found of it, what flows, what is taken of it."""
    return numpy.array([(matte & where).sum() for where in (truth, truth & guess, ~truth, ~truth & guess)])


def print_clicks(counts):
    """counts: of (start, held out, clicks) the pictures'."""
    print("| start | pictures | " + " | ".join(map(str, CLICKS)) + " |\n| --- | --- |" + " --: |" * len(CLICKS))
    for (start, apart), rows in counts.items():
        rows = numpy.array(rows, float)  # picture, clicks, counted
        with numpy.errstate(invalid="ignore"):
            found, taken = 100 * rows[..., 1] / rows[..., 0], 100 * rows[..., 3] / rows[..., 2]
        for called, of, digits in (("found, median", numpy.nanmedian(found, 0), 0), ("found, mean", numpy.nanmean(found, 0), 0),
                                   ("taken, median", numpy.median(taken, 0), 1), ("taken, mean", taken.mean(0), 1)):
            print(f"| {start} | {'held out' if apart else 'set'}, {called} | " + " | ".join(f"{value:.{digits}f}" for value in of) + " |")


def learned(samples, steps=25, ridge=.05):
    """Logistic regression: mean and deviation of each figure, weight per deviation, and the offset, last."""
    figures, stands, weight = (numpy.concatenate(part) for part in zip(*samples))
    mean, deviation, weight = figures.mean(0), figures.std(0), weight / weight.sum()
    off = numpy.hstack([numpy.clip((figures - mean) / deviation, -FARTHEST, FARTHEST), numpy.ones((len(figures), 1))])
    weights = numpy.zeros(off.shape[1])
    for _ in range(steps):
        guess = 1 / (1 + numpy.exp(-off @ weights))
        slope = off.T @ (weight * (guess - stands)) + ridge * numpy.append(weights[:-1], 0)
        curve = (off * (weight * guess * (1 - guess))[:, None]).T @ off + ridge * numpy.eye(len(weights))
        weights -= numpy.linalg.solve(curve, slope)
    return mean, deviation, weights


def write_weights(path, pictures):
    """pictures: of each of the set its figures within the matte, and what stands of them. The least score is the one by which pictures
    left out, a quarter at a time, lose MOST_TAKEN of their fluid in the mean."""
    lot, samples = numpy.random.default_rng(1), []
    for figures, stands in pictures:
        part = []
        for said, share in ((True, .3), (False, 1)):  # a picture's fluid counts as another's, its stones as .3 of it
            at = numpy.flatnonzero(stands == said)
            if len(at) >= 60:
                at = lot.choice(at, min(3000, len(at)), replace=False)
                part.append((figures[at], stands[at], numpy.full(len(at), share / len(at))))
        samples.append(tuple(numpy.concatenate(column) for column in zip(*part)))
    scores = []
    for fold in range(4):
        mean, deviation, weights = learned([s for i, s in enumerate(samples) if i % 4 != fold])
        for figures, stands in pictures[fold::4]:
            off = numpy.clip((figures - mean) / deviation, -FARTHEST, FARTHEST)
            scores.append((off @ weights[:-1] + weights[-1])[~stands])
    least = next(at for at in numpy.arange(-4, 6, .05) if numpy.mean([(score > at).mean() for score in scores]) <= MOST_TAKEN)
    mean, deviation, weights = learned(samples)
    text = path.read_text()
    names = re.findall(r'{"(\w+)",', text)
    rows = "".join(f'    {{"{name}", {m:.4g}, {d:.4g}, {w:.4g}}},\n' for name, m, d, w in zip(names, mean, deviation, weights, strict=False))
    text = re.sub(r"kStandingOffset = .*?;", f"kStandingOffset = {weights[-1]:.4g}, kLeastScore = {least:.4g}, kFarthestFigure = {FARTHEST};", text)
    path.write_text(re.sub(r"( +{\"\w+\", .*\n)+", lambda _: rows, text))


def main():
    options = argparse.ArgumentParser(usage=__doc__)
    options.add_argument("mattes", type=pathlib.Path)
    options.add_argument("--guesses", type=pathlib.Path)
    options.add_argument("--holds", type=pathlib.Path, default=pathlib.Path(__file__).with_name("holds.toml"))
    options.add_argument("--sheets", type=pathlib.Path)
    options.add_argument("--weights", type=pathlib.Path)
    options.add_argument("--draw", type=pathlib.Path)
    options.add_argument("--clicks", action="store_true")
    said = options.parse_args()
    holds = tomllib.loads(said.holds.read_text())
    apart = held_out(list(holds))
    pictures = []
    counts = {False: [], True: []}
    clicked = {(start, is_apart): [] for start in STARTS for is_apart in (False, True)}
    print("| picture | held out | stands % | found % | fluid taken % |\n| --- | --- | --: | --: | --: |")
    for name, hold in holds.items():
        still, matte = (cv2.imread(str(said.mattes / (name + ending)), how) for ending, how in (("_still.png", 1), ("_matte.png", 0)))
        if still is None or matte is None:
            raise SystemExit(f"{said.mattes}: no still or no matte of {name}: make them with first_takes.py")
        matte = matte > 127
        truth = drawn(matte.shape, hold)
        guess = numpy.zeros(matte.shape, bool)

        def read(ending):
            picture = cv2.imread(str(said.guesses / (name + ending)), 0)
            if picture is None or picture.shape != matte.shape:
                raise SystemExit(f"{said.guesses}: no {name}{ending} of the still's size")
            return picture > 127

        if said.guesses:
            guess = read("_hold.png")
        if said.draw:
            said.draw.mkdir(parents=True, exist_ok=True)
            cv2.imwrite(str(said.draw / (name + ".png")), truth.astype(numpy.uint8) * 255)
        if said.clicks:
            for start in STARTS:
                clicked[start, name in apart].append([counted(matte, truth, read(f"_{start}_{count}.png")) for count in CLICKS])
            guess = read("_plain_none_5.png")
        of = counted(matte, truth, guess)
        counts[name in apart].append(of)
        found = f"{100 * of[1] / of[0]:.0f}" if of[0] else "-"
        print(f"| {name} | {'yes' if name in apart else ''} | {100 * of[0] / matte.sum():.1f} | {found} | {100 * of[3] / of[2]:.1f} |")
        if said.weights and name not in apart:
            figures = numpy.fromfile(said.guesses / (name + ".figures"), numpy.float32).reshape(-1, matte.size).T
            inside = matte.ravel() & (figures[:, -1] < 128)
            pictures.append((figures[inside, :-1], truth.ravel()[inside]))
        if said.sheets:
            said.sheets.mkdir(parents=True, exist_ok=True)
            cv2.imwrite(str(said.sheets / (name + ".png")), sheet(still, matte, truth, guess))
    for is_apart, rows in counts.items():
        of, called = numpy.sum(rows, axis=0), "held out" if is_apart else "set"
        stands, found, taken = 100 * of[0] / (of[0] + of[2]), 100 * of[1] / of[0], 100 * of[3] / of[2]
        print(f"| {called}, of all pixels | | {stands:.1f} | {found:.0f} | {taken:.1f} |")
        stands = numpy.mean([100 * of[0] / (of[0] + of[2]) for of in rows])
        found = numpy.mean([100 * of[1] / of[0] for of in rows if of[0]])
        taken = numpy.mean([100 * of[3] / of[2] for of in rows])
        print(f"| {called}, mean of pictures | | {stands:.1f} | {found:.0f} | {taken:.1f} |")
    if said.clicks:
        print_clicks(clicked)
    if said.weights:
        write_weights(said.weights, pictures)


if __name__ == "__main__":
    main()
