// media/frame/plain_frame.h — a decoder's frame as plain little-endian planes. Private to this room.
#pragma once

#include "media/frame/frame.h"
#include "media/frame/libav.h"

namespace freshet::media {

/// The format in which frames of `format` are handed out. It is `format` itself wherever its planes are plain
/// bytes or little-endian words (alpha planes, semi-planar, packed and floating-point formats included).
/// Otherwise it is the one into which it goes without loss:
///   yuvj420p, yuvj422p, ...  the same planes named yuv420p, ... (the layout says the range)
///   pal8                     bgra, through the palette
///   monow, monob             gray, 0 and 255
///   big-endian 16 bit        the little-endian twin (16-bit PNG decodes to rgb48be)
/// AV_PIX_FMT_NONE for anything else (frames on a GPU, 4 bits per pixel, 32-bit big endian).
AVPixelFormat plain_format(AVPixelFormat format);

/// Colours, size and aspect of a decoded frame; rotation is left 0.
PixelLayout layout_of(const AVFrame& frame);

/// The planes of a decoded frame whose plain_format is not none. Shares the decoder's memory where nothing
/// had to be converted: the samples are to be read only. Time is left 0.
Frame plain_frame(AvOwner<AVFrame> frame, const PixelLayout& layout);

}  // namespace freshet::media
