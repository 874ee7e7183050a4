// tests/media/exr_channel.h — one channel of an EXR of parts, by OpenEXR alone.
#pragma once

#include <string>

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <opencv2/core.hpp>

namespace freshet {

/// CV_32F.
inline cv::Mat exr_channel(const std::string& file, int part, const std::string& name) {
  Imf::MultiPartInputFile parts(file.c_str());
  Imf::InputPart from(parts, part);
  const Imath::Box2i window = from.header().dataWindow();
  cv::Mat plane(window.max.y + 1, window.max.x + 1, CV_32F);
  Imf::FrameBuffer buffer;
  buffer.insert(name,
                Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data), sizeof(float), plane.step[0]));
  from.setFrameBuffer(buffer);
  from.readPixels(0, plane.rows - 1);
  return plane;
}

}  // namespace freshet
