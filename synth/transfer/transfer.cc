#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

struct Transfer::Impl {
  Exemplar exemplar;
  TransferOptions options;
  int frame = 0;
};

Transfer::Transfer(Exemplar exemplar, const TransferOptions& options)
    : impl_(std::make_unique<Impl>(Impl{std::move(exemplar), options})) {
  check(options);
}
Transfer::Transfer(Transfer&&) noexcept = default;
Transfer& Transfer::operator=(Transfer&&) noexcept = default;
Transfer::~Transfer() = default;

int Transfer::frame() const { return impl_->frame; }

TransferredFrame Transfer::next(const TargetFrame& target, const std::function<void(double share)>&) {
  TransferredFrame made;
  made.index = impl_->frame++;
  made.bgra = cv::Mat(target.alpha.size(), CV_32FC4, cv::Scalar::all(0));
  return made;
}
void Transfer::save_state(const std::filesystem::path&) const {}
void Transfer::load_state(const std::filesystem::path&) {}

}  // namespace freshet::synth::transfer
