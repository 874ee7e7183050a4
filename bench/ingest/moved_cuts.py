#!/usr/bin/env python3
"""How much of footage whose camera moves by a known amount does `freshet ingest` use, and how still is it then?

usage: moved_cuts.py FRESHET CLIPS OUT [--count 100] [--seed 1] [--tripod] [--but NAME]...

Draws COUNT clips of the tripod footage below CLIPS, and films each anew in OUT: a window of 70 % of it, 480 px wide, shakes, pans, or
is cut to another clip in its middle (kinds in turn). A frame is the clip's own, so the fluid moves as it did; only the camera is
ours. Then `ingest --dry-run` and `ingest --steady --dry-run`; the table says what share of the seconds is used as it is, and with
--steady, and how many cuts are found to a frame. --tripod makes the same films with a camera that stands, so that stores made of both
can be compared (bench_quality STORE --held-out FOLDER); --but leaves a clip out.
"""
import argparse
import json
import pathlib
import random
import subprocess

import cv2
import numpy

WIDTH, WINDOW, SECONDS = 480, .7, 4
# Of the window's diagonal: shake is the standard deviation from frame to frame (smoothed over a tenth of a second), pan is a second.
KINDS = {"tripod": (0, 0), "shake .2 %": (.002, 0), "shake .5 %": (.005, 0), "shake 1 %": (.01, 0), "pan .5 %/s": (0, .005),
         "pan 1 %/s": (0, .01), "pan 3 %/s": (0, .03), "shake .5 %, pan 1 %/s": (.005, .01), "cut": (0, 0)}


def frames_of(path, count):
    video, frames = cv2.VideoCapture(str(path)), []
    while len(frames) < count:
        there, frame = video.read()
        if not there:
            break
        frames.append(frame)
    return frames, video.get(cv2.CAP_PROP_FPS)


def filmed(frames, fps, shake, pan, rng):
    """The window over time, and where it was, in px of what is written."""
    height, width = frames[0].shape[:2]
    scale = WIDTH / (WINDOW * width)
    size = (WIDTH, int(WINDOW * height * scale) // 2 * 2)
    diagonal = numpy.hypot(*size)
    times = numpy.arange(len(frames)) / fps
    steps = rng.normal(0, 1, (len(frames) + 8, 2))
    smooth = numpy.array([steps[i:i + max(1, round(fps / 10))].mean(0) for i in range(len(frames))])
    direction, middle = rng.uniform(0, 2 * numpy.pi), (1 - WINDOW) * rng.uniform(.35, .65, 2)
    at = shake * diagonal * smooth / max(smooth.std(), 1e-9)
    at += pan * diagonal * (times - times.mean())[:, None] * [numpy.cos(direction), numpy.sin(direction)]
    out = []
    for frame, (x, y) in zip(frames, at):
        corner = middle * [width, height] + numpy.array([x, y]) / scale
        corner = numpy.clip(corner, 0, [(1 - WINDOW) * width, (1 - WINDOW) * height])
        out.append(cv2.warpAffine(frame, numpy.float64([[scale, 0, -corner[0] * scale], [0, scale, -corner[1] * scale]]), size,
                                  flags=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR))
    return out


def write(path, frames, fps):
    height, width = frames[0].shape[:2]
    sink = subprocess.Popen(["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "bgr24", "-s", f"{width}x{height}", "-r", str(fps),
                             "-i", "-", "-c:v", "libx264", "-preset", "veryfast", "-crf", "18", "-pix_fmt", "yuv420p", str(path)],
                            stdin=subprocess.PIPE)
    for frame in frames:
        sink.stdin.write(numpy.ascontiguousarray(frame).tobytes())
    sink.stdin.close()
    if sink.wait():
        raise SystemExit(f"{path}: ffmpeg could not write it")


def taken(freshet, folder, *options):
    """Of each film: its parts that would be taken, as (first frame, frames, fps)."""
    said = subprocess.run([freshet, "ingest", folder / "none.store", folder, "--dry-run", "--json", *options], capture_output=True, text=True)
    rows = {}
    for clip in json.loads(said.stdout)["clips"]:
        if clip["outcome"] == "would be added":
            part = clip["part"] or {"first_frame": 0, "frames": clip["frames"]}
            rows.setdefault(pathlib.Path(clip["name"].split("@")[0]).stem, []).append((part["first_frame"], part["frames"], clip["fps"]))
    return rows


def main():
    options = argparse.ArgumentParser(usage=__doc__)
    options.add_argument("freshet")
    options.add_argument("clips", type=pathlib.Path)
    options.add_argument("out", type=pathlib.Path)
    options.add_argument("--count", type=int, default=100)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--tripod", action="store_true")
    options.add_argument("--but", action="append", default=[], metavar="NAME")
    said = options.parse_args()
    said.out.mkdir(parents=True)
    rng = numpy.random.default_rng(said.seed)
    still = [pathlib.Path(clip["name"]) for clip in json.loads(subprocess.run(
        [said.freshet, "ingest", said.out / "none.store", said.clips, "--dry-run", "--json"], capture_output=True, text=True).stdout)["clips"]
        if clip["outcome"] == "would be added" and not clip["part"] and clip["screening"]["drift"] < .01]
    still = [said.clips / name for name in sorted(still) if name.stem not in said.but]
    order = random.Random(said.seed).choices(still, k=said.count)
    films = {}  # name: kind, frames, fps, frame of the cut
    for i in range(said.count):
        kind, (shake, pan) = ("tripod", (0, 0)) if said.tripod else list(KINDS.items())[i % len(KINDS)]
        frames, fps = frames_of(order[i], 1 << 30)
        frames = frames[:round(SECONDS * fps)]
        film, cut = filmed(frames, fps, shake, pan, rng), 0
        if kind == "cut":
            after = filmed(frames_of(next(path for path in order[i:] + order if path != order[i]), len(frames))[0], fps, 0, 0, rng)
            cut = len(film) // 2
            film = film[:cut] + [cv2.resize(frame, film[0].shape[1::-1]) for frame in after[cut:]]
        name = f"{i:03}_{order[i].stem}"
        folder = said.out / order[i].parent.name
        folder.mkdir(exist_ok=True)
        write(folder / (name + ".mp4"), film, fps)
        films[name] = kind, len(film), fps, cut
    plain, steady = taken(said.freshet, said.out), taken(said.freshet, said.out, "--steady")
    print("| camera | films | seconds | used as it is % | with --steady % |\n| --- | --: | --: | --: | --: |")
    for kind in [*KINDS, "all"]:
        of = {name: film for name, film in films.items() if kind in (film[0], "all")}
        seconds = sum(count / fps for _, count, fps, _ in of.values())
        used = [100 * sum(frames / fps for name in of for _, frames, fps in rows.get(name, [])) / max(seconds, 1e-9) for rows in (plain, steady)]
        print(f"| {kind} | {len(of)} | {seconds:.0f} | {used[0]:.0f} | {used[1]:.0f} |")
    cuts = {name: film[3] for name, film in films.items() if film[3]}
    found = [name for name, cut in cuts.items() if any(first == cut for first, _, _ in plain.get(name, []))]
    across = [name for name, cut in cuts.items() if any(first < cut < first + frames for first, frames, _ in plain.get(name, []))]
    print(f"\n{len(cuts)} cuts: {len(found)} found to the frame; {len(across)} lie inside a part that is taken.")


if __name__ == "__main__":
    main()
