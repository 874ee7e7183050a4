"""Animates a picture with the clips of a store.   animate.py STORE PICTURE MATTE VIDEO"""
import sys

import freshet

store, picture, matte, video = sys.argv[1:]
picture = freshet.read_picture(picture).bgr
size = (picture.shape[1], picture.shape[0])
matte = freshet.read_matte(matte, size).alpha
search = freshet.search(freshet.Store(store), picture, matte, class_name="fall", frames=8)
with freshet.VideoWriter(video, size, frames=8) as writer:
    for frame in freshet.animate(freshet.label(search)):
        writer.write(frame)
