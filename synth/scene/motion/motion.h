// synth/scene/motion/motion.h — how one layer moves, frame by frame, absolute from the still.
#pragma once

namespace freshet::synth::scene {

/// A motion texture (Chuang et al. 2005, Eq. 2): a layer's pixel p shows what the still has at p + d'(p, t). Frames may
/// be asked in any order; go_to() comes first and is the only call that writes, so that rows can be asked by many
/// threads.
class Motion {
 public:
  virtual ~Motion() = default;

  virtual void go_to(int frame) = 0;
  /// To the frame after this one, its copies gone on from where this one has them; where a loop begins anew, a copy of
  /// frame 0 may lie elsewhere.
  virtual void go_on_from(int frame) { go_to(frame + 1); }
  /// px: no |d'| of this frame is greater, in x or in y.
  virtual float reach() const = 0;

  /// d' of n pixels from (x, y) on, px. Pixels may lie anywhere; (0, 0) is the picture's first, at its middle.
  /// copy   0, or 1 where the frame is a mixture of two.
  virtual void row(int copy, int x, int y, int n, float* dx, float* dy) const = 0;
  /// Of copy 1 in the mixture at n pixels, 0..1; false: copy 0 is all there is, and nothing was written.
  virtual bool second(int /*x*/, int /*y*/, int /*n*/, float* /*part*/) const { return false; }
  /// Factors of the light at n pixels; false: it is 1 everywhere, and nothing was written.
  virtual bool light(int /*x*/, int /*y*/, int /*n*/, float* /*factor*/) const { return false; }
};

}  // namespace freshet::synth::scene
