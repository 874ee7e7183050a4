#!/usr/bin/env python3
"""Is what stands inside a matte found? Guesses of what to hold beside hand-drawn ones (holds.toml).

usage: holds.py MATTES [--guesses FOLDER] [--holds FILE] [--sheets FOLDER]

MATTES holds NAME_still.png and NAME_matte.png of 640 px, as first_takes.py leaves them; FOLDER NAME_hold.png, white where the guess
holds (none: nothing is held). Prints for each picture what share of its matte is drawn as standing; how much of that is found; and
how much of the fluid is taken. Then the same over all pixels, and as a mean over pictures: of the set, and of the pictures held out,
which no constant may be set by.
Sheets, for the eye: found green, missed red, taken from the fluid yellow, the matte's outline white.
"""
import argparse
import hashlib
import pathlib
import tomllib

import cv2
import numpy


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


def main():
    options = argparse.ArgumentParser(usage=__doc__)
    options.add_argument("mattes", type=pathlib.Path)
    options.add_argument("--guesses", type=pathlib.Path)
    options.add_argument("--holds", type=pathlib.Path, default=pathlib.Path(__file__).with_name("holds.toml"))
    options.add_argument("--sheets", type=pathlib.Path)
    said = options.parse_args()
    holds = tomllib.loads(said.holds.read_text())
    apart = held_out(list(holds))
    counts = {False: [], True: []}  # of each picture: drawn, found, fluid, taken
    print("| picture | held out | stands % | found % | fluid taken % |\n| --- | --- | --: | --: | --: |")
    for name, hold in holds.items():
        still, matte = (cv2.imread(str(said.mattes / (name + ending)), how) for ending, how in (("_still.png", 1), ("_matte.png", 0)))
        if still is None or matte is None:
            raise SystemExit(f"{said.mattes}: no still or no matte of {name}: make them with first_takes.py")
        matte = matte > 127
        truth = drawn(matte.shape, hold)
        guess = numpy.zeros(matte.shape, bool)
        if said.guesses:
            picture = cv2.imread(str(said.guesses / (name + "_hold.png")), 0)
            if picture is None or picture.shape != matte.shape:
                raise SystemExit(f"{said.guesses}: no {name}_hold.png of the still's size")
            guess = picture > 127
        of = numpy.array([(matte & truth).sum(), (matte & truth & guess).sum(), (matte & ~truth).sum(), (matte & ~truth & guess).sum()])
        counts[name in apart].append(of)
        found = f"{100 * of[1] / of[0]:.0f}" if of[0] else "-"
        print(f"| {name} | {'yes' if name in apart else ''} | {100 * of[0] / matte.sum():.1f} | {found} | {100 * of[3] / of[2]:.1f} |")
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


if __name__ == "__main__":
    main()
