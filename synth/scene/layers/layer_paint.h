// synth/scene/layers/layer_paint.h — cut layers as layers of paint, and back after a person painted over them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "media/picture/openraster.h"
#include "synth/scene/layers/cut_layers.h"

namespace freshet::synth::scene {

/// Name of a hidden layer on top that shows what was filled in, for a person to find it.
inline constexpr const char* kFilledName = "(filled in)";

enum class PaintBits { k8, k16 };

/// A layer of paint for each layer, of its name, and kFilledName where anything was filled in.
/// Laid over each other the layers of 8 bits give the picture's 8 bits within a level; those of 16 its 16.
media::OpenRaster to_paint(std::span<const CutLayer> nearest_first, PaintBits bits);

/// One layer of paint as a cut layer; its opacity is in its alpha. filled is empty.
CutLayer from_paint(const media::RasterLayer& paint, cv::Size canvas);

/// The layers of these names, whatever their order in the file. A hidden one is taken, for a painter hides layers
/// to see what is below them.
/// where      the file, for messages.
/// notices    for a person, when not null: layers that nobody asked for.
/// Throws     Error{kInput} naming the file and the layer: one is missing, two have its name, nothing is in it, or
///            the canvas has another size than the picture.
std::vector<CutLayer> from_paint(const media::OpenRaster& paint, std::span<const std::string> names,
                                 cv::Size picture, const std::string& where,
                                 std::vector<std::string>* notices = nullptr);

}  // namespace freshet::synth::scene
