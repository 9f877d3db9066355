#include "saccade/inspection/video_writer.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

struct FreeFormat {
  void operator()(AVFormatContext* format) const {
    if (format->pb != nullptr) avio_closep(&format->pb);
    avformat_free_context(format);
  }
};
struct FreeCodec {
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
};
struct FreeFrame {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct FreePacket {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct FreeScaler {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};

std::string errorText(int code) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(code, text.data(), text.size());
  return text.data();
}

}  // namespace

struct VideoWriter::Encoder {
  std::filesystem::path path;
  std::unique_ptr<AVFormatContext, FreeFormat> format;
  std::unique_ptr<AVCodecContext, FreeCodec> codec;
  std::unique_ptr<AVFrame, FreeFrame> frame;
  std::unique_ptr<AVPacket, FreePacket> packet;
  std::unique_ptr<SwsContext, FreeScaler> scaler;
  AVStream* stream = nullptr;
  bool finished = false;

  void require(int code, const char* expected) const {
    if (code < 0) throw IoError(path, expected, errorText(code));
  }

  void openFormat() {
    AVFormatContext* raw = nullptr;
    avformat_alloc_output_context2(&raw, nullptr, "mp4", path.c_str());
    format.reset(raw);
    if (!format) throw IoError(path, "an MP4 file to be made", "no MP4 support in libavformat");
    require(avio_open(&format->pb, path.c_str(), AVIO_FLAG_WRITE), "a video file that can be written");
  }

  void openCodec(cv::Size size, double frames_per_second) {
    const AVCodec* kind = avcodec_find_encoder_by_name("libx264");
    if (kind == nullptr) kind = avcodec_find_encoder(AV_CODEC_ID_MPEG4);
    if (kind == nullptr) throw IoError(path, "an H.264 or MPEG-4 encoder", "none in libavcodec");
    codec.reset(avcodec_alloc_context3(kind));
    codec->width = size.width;
    codec->height = size.height;
    codec->pix_fmt = AV_PIX_FMT_YUV420P;
    codec->time_base = {1000, static_cast<int>(std::lround(frames_per_second * 1000.0))};
    codec->gop_size = 30;  // a fragment begins at each key frame: a kill loses about a second
    codec->thread_count = 1;
    codec->bit_rate = 4'000'000;
    if (kind->id == AV_CODEC_ID_H264) {
      codec->bit_rate = 0;
      av_opt_set(codec->priv_data, "preset", "superfast", 0);
      av_opt_set(codec->priv_data, "crf", "23", 0);
      av_opt_set(codec->priv_data, "tune", "zerolatency", 0);  // no pictures held back for a kill to lose
    }
    if ((format->oformat->flags & AVFMT_GLOBALHEADER) != 0) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    require(avcodec_open2(codec.get(), kind, nullptr), "the video encoder to start");
  }

  void writeHeader() {
    stream = avformat_new_stream(format.get(), nullptr);
    require(avcodec_parameters_from_context(stream->codecpar, codec.get()), "usable video parameters");
    stream->time_base = codec->time_base;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "movflags", "frag_keyframe+empty_moov+default_base_moof", 0);
    const int written = avformat_write_header(format.get(), &options);
    av_dict_free(&options);
    require(written, "the video header to be written");
  }

  /// Encodes `picture`, or with nullptr drains the encoder, and writes every packet that comes out.
  void encode(const AVFrame* picture) {
    require(avcodec_send_frame(codec.get(), picture), "a picture to be encoded");
    while (true) {
      const int received = avcodec_receive_packet(codec.get(), packet.get());
      if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return;
      require(received, "an encoded picture");
      av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
      packet->stream_index = stream->index;
      require(av_interleaved_write_frame(format.get(), packet.get()), "room for the video");
      avio_flush(format->pb);
      require(format->pb->error, "room for the video");
    }
  }
};

VideoWriter::VideoWriter(const std::filesystem::path& path, cv::Size size, double frames_per_second)
    : encoder_(std::make_unique<Encoder>()) {
  if (size.width % 2 != 0 || size.height % 2 != 0 || size.empty()) {
    throw std::invalid_argument("VideoWriter: expected even sides, found " + std::to_string(size.width) + " x " +
                                std::to_string(size.height));
  }
  av_log_set_level(AV_LOG_ERROR);
  encoder_->path = path;
  encoder_->openFormat();
  encoder_->openCodec(size, frames_per_second);
  encoder_->writeHeader();

  encoder_->packet.reset(av_packet_alloc());
  encoder_->frame.reset(av_frame_alloc());
  AVFrame& frame = *encoder_->frame;
  frame.format = AV_PIX_FMT_YUV420P;
  frame.width = size.width;
  frame.height = size.height;
  frame.pts = 0;
  encoder_->require(av_frame_get_buffer(&frame, 0), "memory for a picture");
  encoder_->scaler.reset(sws_getContext(size.width, size.height, AV_PIX_FMT_BGR24, size.width, size.height,
                                        AV_PIX_FMT_YUV420P, SWS_POINT, nullptr, nullptr, nullptr));
}

VideoWriter::~VideoWriter() {
  try {
    finish();
  } catch (const IoError&) {
    // A destructor has nobody to tell; callers that want to know call finish().
    encoder_->finished = true;
  }
}

void VideoWriter::write(const cv::Mat3b& bgr) {
  AVFrame& frame = *encoder_->frame;
  if (bgr.cols != frame.width || bgr.rows != frame.height) {
    throw std::invalid_argument("VideoWriter: expected pictures of " + std::to_string(frame.width) + " x " +
                                std::to_string(frame.height) + ", found " + std::to_string(bgr.cols) + " x " +
                                std::to_string(bgr.rows));
  }
  encoder_->require(av_frame_make_writable(&frame), "memory for a picture");
  const std::uint8_t* planes[] = {bgr.ptr()};
  const int strides[] = {static_cast<int>(bgr.step[0])};
  sws_scale(encoder_->scaler.get(), planes, strides, 0, frame.height, frame.data, frame.linesize);
  encoder_->encode(&frame);
  ++frame.pts;
}

void VideoWriter::finish() {
  if (encoder_->finished) return;
  encoder_->finished = true;
  encoder_->encode(nullptr);
  encoder_->require(av_write_trailer(encoder_->format.get()), "room for the end of the video");
  avio_flush(encoder_->format->pb);
  encoder_->require(encoder_->format->pb->error, "room for the end of the video");
}

}  // namespace saccade
