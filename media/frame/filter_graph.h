// media/frame/filter_graph.h — decoded frames through FFmpeg's filters. Private to this room.
#pragma once

#include <memory>
#include <string>

#include "media/frame/libav.h"

struct AVFilterGraph;
struct AVFilterContext;

namespace freshet::media {

/// A chain of filters that takes frames of one format and size and gives frames of the same, or of another format.
class FilterGraph {
 public:
  /// text   as ffmpeg -vf takes it. first   a frame like all that will come. time_base   of their stamps.
  /// where  names the file in messages. Throws Error{kInput} when the filters cannot take such frames.
  /// out    format of the frames given; none: that of the frames taken.
  FilterGraph(const std::string& text, const AVFrame& first, AVRational time_base, std::string where,
              AVPixelFormat out = AV_PIX_FMT_NONE);

  /// Gives a frame in, null at the end. Takes its contents.
  void push(AVFrame* frame);
  /// The next finished frame, null when more must be pushed first, or when all are out.
  AvOwner<AVFrame> pull();
  AVRational time_base() const;

 private:
  struct Close {
    void operator()(AVFilterGraph* graph) const;
  };
  std::unique_ptr<AVFilterGraph, Close> graph_;
  AVFilterContext* source_ = nullptr;
  AVFilterContext* sink_ = nullptr;
  std::string where_;
};

}  // namespace freshet::media
