// synth/transfer/frame_report.h — what a finished frame is made of, for whoever asks.
#pragma once

#include "synth/transfer/exemplar.h"
#include "synth/transfer/retrieval.h"
#include "synth/transfer/segments.h"
#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// How many times the patches of each segment are used: made.boundary, made.interior, and a remark where the
/// exemplar lacks a segment.
void report_use(const NearestField& field, const Segments& source, const Segments& target,
                TransferredFrame& made);

/// made.nearest, distance, violations and mean_distance, of the finest level's field. margin: of `target`, px.
void report_nearest(const NearestField& field, const ExemplarLevel& source, const Segments& target,
                    int margin, TransferredFrame& made);

}  // namespace freshet::synth::transfer
