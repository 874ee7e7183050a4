// media/picture/exr_stream.h — OpenEXR on bytes in memory, its faults as ours.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <opencv2/core.hpp>

namespace freshet::media {

/// Throws   Error{kInput, where} for headers that claim more pixels than `most`, or than the bytes can hold, or
///          attributes, tables or tiles that are not there. OpenEXR allocates what they say.
void require_bounded_exr(std::span<const std::uint8_t> bytes, const std::string& where, std::int64_t most);

/// Opens the bytes, where they are bounded, and hands the file on.
/// where    names the file in messages.
/// Throws   Error{kInput} for what OpenEXR cannot read; what `read` throws.
void read_exr(const std::vector<std::uint8_t>& bytes, const std::string& where, std::int64_t most,
              const std::function<void(Imf::InputFile&)>& read);

/// The address that OpenEXR counts from, for a slice that begins at the data window's first sample in `plane`:
/// window's origin is not (0, 0) in every file.
char* exr_origin(const cv::Mat& plane, const Imf::InputFile& file);

/// All rows of the buffer under the header. Throws Error{kIo} for what OpenEXR cannot encode.
std::vector<std::uint8_t> encode_exr(const Imf::Header& header, const Imf::FrameBuffer& buffer,
                                     const std::string& where);

/// A field of motion with its y turned round: EXR files hold it y up, we y down.
/// motion   CV_32FC2; so is what is returned.
cv::Mat with_y_turned(const cv::Mat& motion);

/// A file of parts; of the headers all but their names and channels are one.
std::vector<std::uint8_t> encode_exr_parts(std::vector<Imf::Header> headers,
                                           std::span<const Imf::FrameBuffer> buffers,
                                           const std::string& where);

}  // namespace freshet::media
