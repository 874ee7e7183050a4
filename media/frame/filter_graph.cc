#include "media/frame/filter_graph.h"

extern "C" {
#include <libavfilter/avfilter.h>
#include <libavfilter/buffersink.h>
#include <libavfilter/buffersrc.h>
}

#include <new>
#include <utility>

#include "freshet/error.h"
#include "media/frame/repair.h"

namespace freshet::media {

std::string filter_text(const Repairs& repairs, int rotation) {
  std::string text;
  const auto add = [&text](const char* filter) { text += std::string(text.empty() ? "" : ",") + filter; };
  // Fields and blocks lie along the frame's own rows: they are mended before it is turned.
  if (repairs.deinterlace) add("bwdif=mode=send_frame");
  if (repairs.deblock) add("deblock=filter=strong");
  if (repairs.sdr)
    add("zscale=transfer=linear:npl=203,format=gbrpf32le,zscale=primaries=bt709,"
        "tonemap=mobius:desat=0:peak=4.926,zscale=transfer=bt709:matrix=bt709:range=limited");
  if (!repairs.upright) return text;
  if (rotation == 90) add("transpose=clock");
  if (rotation == 180) add("hflip,vflip");
  if (rotation == 270) add("transpose=cclock");
  return text;
}

void FilterGraph::Close::operator()(AVFilterGraph* graph) const { avfilter_graph_free(&graph); }

FilterGraph::FilterGraph(const std::string& text, const AVFrame& first, AVRational time_base,
                         std::string where, AVPixelFormat out)
    : graph_(avfilter_graph_alloc()), where_(std::move(where)) {
  quiet_libav();
  if (!graph_) throw std::bad_alloc();
  graph_->nb_threads =
      1;  // frames are worked on beside each other elsewhere; the result must not depend on it
  const auto format = static_cast<AVPixelFormat>(first.format);
  const std::string input = "video_size=" + std::to_string(first.width) + "x" + std::to_string(first.height) +
                            ":pix_fmt=" + std::to_string(first.format) +
                            ":time_base=" + std::to_string(time_base.num) + "/" +
                            std::to_string(time_base.den);
  // Never a conversion to another format and back unseen: what a filter cannot take is refused.
  avfilter_graph_set_auto_convert(graph_.get(), AVFILTER_AUTO_CONVERT_NONE);
  const char* name = av_get_pix_fmt_name(format);
  const char* given = out == AV_PIX_FMT_NONE ? name : av_get_pix_fmt_name(out);
  const std::string chain = text + ",format=pix_fmts=" + (given ? given : "none");
  AVFilterInOut* open_inputs = avfilter_inout_alloc();
  AVFilterInOut* open_outputs = avfilter_inout_alloc();
  int code = open_inputs && open_outputs ? 0 : AVERROR(ENOMEM);
  if (code >= 0)
    code = avfilter_graph_create_filter(&source_, avfilter_get_by_name("buffer"), "in", input.c_str(),
                                        nullptr, graph_.get());
  if (code >= 0)
    code = avfilter_graph_create_filter(&sink_, avfilter_get_by_name("buffersink"), "out", nullptr, nullptr,
                                        graph_.get());
  if (code >= 0) {
    *open_outputs = {.name = av_strdup("in"), .filter_ctx = source_, .pad_idx = 0, .next = nullptr};
    *open_inputs = {.name = av_strdup("out"), .filter_ctx = sink_, .pad_idx = 0, .next = nullptr};
    code = avfilter_graph_parse_ptr(graph_.get(), chain.c_str(), &open_inputs, &open_outputs, nullptr);
  }
  if (code >= 0) code = avfilter_graph_config(graph_.get(), nullptr);
  avfilter_inout_free(&open_inputs);
  avfilter_inout_free(&open_outputs);
  if (code < 0)
    throw Error(ErrorKind::kInput, where_,
                "its frames (" + std::string(name ? name : "unknown format") + ") cannot go through " + text +
                    " (" + libav_fault(code) + ")",
                "Ingest it without repairs, or convert it first: ffmpeg -i FILE -c:v ffv1 -pix_fmt yuv420p");
}

void FilterGraph::push(AVFrame* frame) {
  const int code = av_buffersrc_add_frame(source_, frame);
  if (code < 0)
    throw Error(ErrorKind::kInput, where_, "a frame could not be repaired (" + libav_fault(code) + ")");
}

AvOwner<AVFrame> FilterGraph::pull() {
  AvOwner<AVFrame> frame = new_frame();
  const int code = av_buffersink_get_frame(sink_, frame.get());
  if (code >= 0) return frame;
  if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return nullptr;
  throw Error(ErrorKind::kInput, where_, "a frame could not be repaired (" + libav_fault(code) + ")");
}

AVRational FilterGraph::time_base() const { return av_buffersink_get_time_base(sink_); }

}  // namespace freshet::media
