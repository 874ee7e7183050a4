#!/usr/bin/env python3
"""How fast are random videos of patches read from a store, beside decoding the source clips with OpenCV?

usage: patch_rate.py STORE CLIPS [COUNT [FRAMES]]     CLIPS: the folder that was ingested; COUNT [10000] videos of FRAMES [96]

OpenCV seeks to the first frame of each video, decodes FRAMES whole frames and cuts a square out: no scaling or turning, which
the sampler does as well. It is asked for a part of the videos; the other way is to decode each clip once and to cut all of
its videos out, which gives them in the clip's order. The answers are compared first, where patches are the clip's own pixels.
"""
import json
import os
import platform
import sys
import time

import cv2
import freshet
import numpy

BATCH = 64


def decoded(folder, at, frames):
    video = cv2.VideoCapture(os.path.join(folder, at.clip))
    video.set(cv2.CAP_PROP_POS_FRAMES, at.first)
    return numpy.array([video.read()[1] for _ in range(frames)])


def compare(store, sampler, folder, frames):
    """Mean difference of the first patches that need no resampling, levels of 255."""
    differences = []
    columns = {clip.name: store[clip.name] for clip in store.clips}
    columns = {name: [one.column("patch." + axis) for axis in ("variant", "x", "y")] for name, one in columns.items()}
    for i in range(len(sampler)):
        at = sampler.at(i)
        number, x, y = (int(column[at.patch]) for column in columns[at.clip])
        variant = store.variants[number]
        if (variant.scale, variant.rotation_deg, variant.flip) != (1, 0, False):
            continue
        source = decoded(folder, at, frames)[:, y:y + sampler.side, x:x + sampler.side]
        differences.append(numpy.abs(source.astype(int) - sampler[i]).mean())
        if len(differences) == 3:
            break
    return float(numpy.mean(differences))


def main():
    store_path, folder = sys.argv[1:3]
    count, frames = (int(value) for value in (sys.argv[3:] + ["10000", "96"])[:2])
    begin = time.perf_counter()
    store = freshet.Store(store_path)
    sampler = freshet.Sampler(store, seed=1, frames=frames)
    sampler.read(0, 1)
    first_video = time.perf_counter() - begin
    sampler.read(0, BATCH)
    first_batch = time.perf_counter() - begin
    count = min(count, len(sampler))
    difference = compare(store, sampler, folder, frames)
    assert difference < 2, difference

    rates = {}
    for name, colour in (("store, BGR", True), ("store, luminance", False)):
        sampler = freshet.Sampler(store, seed=1, frames=frames, colour=colour)
        begin = time.perf_counter()
        for at in range(0, count, BATCH):
            sampler.read(at, min(BATCH, count - at))
        rates[name] = count / (time.perf_counter() - begin)

    begin = time.perf_counter()
    decoded(folder, sampler.at(0), frames)
    opencv_first = time.perf_counter() - begin
    asked, begin = 0, time.perf_counter()
    while time.perf_counter() - begin < 30 and asked < count:
        at = sampler.at(asked)
        numpy.ascontiguousarray(decoded(folder, at, frames)[:, :48, :48])
        asked += 1
    rates["OpenCV, a video at a time"] = asked / (time.perf_counter() - begin)

    begin = time.perf_counter()
    for clip in store.clips:
        video = cv2.VideoCapture(os.path.join(folder, clip.name))
        whole = numpy.array([video.read()[1] for _ in range(clip.frames)])
        share = round(count * clip.patches / store.first_patches[-1])
        for i in range(share):
            first = i % max(1, clip.frames - frames + 1)
            numpy.ascontiguousarray(whole[first:first + frames, i % 64:i % 64 + 48, :48])
    rates["OpenCV, each clip once, in order"] = count / (time.perf_counter() - begin)

    print(json.dumps({"machine": platform.processor() or platform.machine(), "cores": os.cpu_count(),
                      "load": os.getloadavg()[0], "clips": len(store), "patches": int(store.first_patches[-1]),
                      "videos": count, "frames": frames, "difference": difference, "first_video_s": first_video,
                      "first_batch_s": first_batch, "opencv_first_video_s": opencv_first, "asked_opencv": asked,
                      "videos_per_s": rates}, indent=1))


if __name__ == "__main__":
    main()
