#include "reporting/html_text.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace saccade {
namespace {

std::string base64Of(const std::string& text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(HtmlText, WhatComesFromASessionCannotBecomeMarkup) {
  EXPECT_EQ(escapedHtml("<b>\"a\" & b</b>"), "&lt;b&gt;&quot;a&quot; &amp; b&lt;/b&gt;");
  EXPECT_EQ(escapedHtml("Küche"), "Küche");
  EXPECT_EQ(escapedHtml("a\xff"), "a\xef\xbf\xbd") << "what is no UTF-8 is replaced";
}

TEST(HtmlText, JsonCannotEndItsScript) {
  const std::string text = jsonForScript({{"input", "</script><script>"}});
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(text)["input"], "</script><script>");
}

TEST(HtmlText, Base64IsThatOfTheRfc) {
  // RFC 4648, section 10.
  EXPECT_EQ(base64Of(""), "");
  EXPECT_EQ(base64Of("f"), "Zg==");
  EXPECT_EQ(base64Of("fo"), "Zm8=");
  EXPECT_EQ(base64Of("foo"), "Zm9v");
  EXPECT_EQ(base64Of("foobar"), "Zm9vYmFy");
}

TEST(HtmlText, APictureKeepsItsBudgetWhateverItShows) {
  cv::Mat3b noise(480, 640);
  cv::randu(noise, cv::Scalar::all(0), cv::Scalar::all(256));
  constexpr std::size_t kBudget_bytes = 20'000;
  const std::string uri = jpegUri(noise, kBudget_bytes);
  EXPECT_LE(uri.size(), kBudget_bytes / 3 * 4 + 40);
  EXPECT_EQ(uri.rfind("data:image/jpeg;base64,", 0), 0u);
}

}  // namespace
}  // namespace saccade
