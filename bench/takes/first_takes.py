#!/usr/bin/env python3
"""First takes of a folder of pictures, as a first-time user makes them: scribbles, two strokes, no option.

usage: first_takes.py FRESHET STORE PICTURES OUT [--asks FILE] [--only NAME,..] [--kinds] [--no-strokes] [--frames N] [-- OPTION..]

Each picture of the asks (first_takes.toml), PICTURES/NAME.* or PICTURES/NAME/input.*, is reduced to 640 px, its matte made by
`freshet synth matte` from the scribbles, and its film by `freshet synth animate` with the strokes and with OPTIONs. OUT gets of each NAME.mkv, the report NAME.json, NAME_matte.png,
and NAME.png for the eye: the still with matte and strokes beside the middle frame, and below both a row and a column of pixels
over time. Prints a table: what the picture looks like, the critic's faults, and what is worst.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tomllib

import cv2
import numpy

SIDE = 640


def read_still(file):
    picture = cv2.imread(str(file))
    scale = SIDE / max(picture.shape[:2])
    return cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC)


def write_scribbles(file, size, ask):
    layer = numpy.zeros((*size, 4), numpy.uint8)
    for key, colour in (("on", (255, 255, 255, 255)), ("beside", (0, 0, 0, 255))):
        for line in ask[key]:
            cv2.polylines(layer, [numpy.int32(line)], False, colour, 7)
    cv2.imwrite(str(file), layer)


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(" ".join(map(str, command)) + "\n" + done.stderr)
    return done.stdout


def frames_of(file):
    film, frames = cv2.VideoCapture(str(file)), []
    while True:
        more, frame = film.read()
        if not more:
            return frames
        frames.append(frame)


def for_the_eye(still, matte, strokes, frames):
    marked = still.copy()
    outlines = cv2.findContours((matte > 127).astype(numpy.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)[0]
    cv2.drawContours(marked, outlines, -1, (0, 0, 255), 1)
    for line in strokes:
        for start, end in zip(line, line[1:]):
            cv2.arrowedLine(marked, start, end, (0, 255, 255), 1, tipLength=.1)
    rows, columns = numpy.nonzero(matte > 127)
    y, x = (int(numpy.median(of)) if len(of) else 0 for of in (rows, columns))
    below = [numpy.stack([frame[y] for frame in frames]), numpy.stack([frame[:, x] for frame in frames])]
    wide = max(2 * still.shape[1], *(part.shape[1] for part in below))
    parts = [numpy.hstack([marked, frames[len(frames) // 2]]), *below]
    return numpy.vstack([numpy.pad(part, ((0, 4), (0, wide - part.shape[1]), (0, 0))) for part in parts])


def main():
    split = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    options = argparse.ArgumentParser(usage=__doc__)
    for name in ("freshet", "store", "pictures", "out"):
        options.add_argument(name, type=pathlib.Path)
    options.add_argument("--asks", type=pathlib.Path, default=pathlib.Path(__file__).with_name("first_takes.toml"))
    options.add_argument("--only", default="")
    options.add_argument("--kinds", action="store_true", help="say each picture's class")
    options.add_argument("--no-strokes", action="store_true", help="the direction is the store's")
    options.add_argument("--frames", type=int, default=72)
    said = options.parse_args(sys.argv[1:split])
    asks = tomllib.loads(said.asks.read_text())
    said.out.mkdir(parents=True, exist_ok=True)
    print("| picture | looks like | faults | worst |\n| --- | --- | --: | --- |")
    for name in said.only.split(",") if said.only else asks:
        source = next((file for at in (name + ".*", name + "/input.*") for file in said.pictures.glob(at)), None)
        if source is None:
            print(f"{name}: not in {said.pictures}: skipped", file=sys.stderr)
            continue
        ask, at = asks[name], lambda ending: said.out / (name + ending)
        drawn = [] if said.no_strokes else ask["strokes"]
        still = read_still(source)
        cv2.imwrite(str(at("_still.png")), still)
        write_scribbles(at("_scribbles.png"), still.shape[:2], ask)
        at(".strokes").write_text(json.dumps({"format": "freshet-strokes", "version": 1,
                                              "strokes": [{"points": line} for line in ask["strokes"]]}))
        run(said.freshet, "synth", "matte", at("_still.png"), "--scribbles", at("_scribbles.png"), "-o", at("_matte.png"), "--overwrite")
        asked = ["--class", ask["kind"]] if said.kinds else []
        asked += ["--strokes", at(".strokes")] if drawn else []
        report = run(said.freshet, "synth", "animate", said.store, at("_still.png"), "--matte", at("_matte.png"),
                     "--frames", said.frames, "-o", at(".mkv"), "--overwrite", "--json", *asked, *sys.argv[split + 1:])
        at(".json").write_text(report)
        cv2.imwrite(str(at(".png")), for_the_eye(still, cv2.imread(str(at("_matte.png")), 0), drawn, frames_of(at(".mkv"))))
        report = json.loads(report)
        verdict, look = report["verdict"], report["looks_like"]
        worst = max(verdict["findings"], key=lambda finding: finding["fault"], default={"measure": "-"})
        sure = "" if look["sure"] else "?"
        print(f"| {name} | {look['class']}{sure} | {verdict['faults']:.1f} | {worst['measure']} |", flush=True)


if __name__ == "__main__":
    main()
