#include "service/telemetry_file/encoding.hpp"

#include <gtest/gtest.h>

namespace reident::telemetry_file::encoding_test {
namespace {

using namespace std::string_literals;

TEST(TelemetryEncoding, IsWhatTheBytesShow) {
  EXPECT_EQ(find_encoding("time,u\n"), "UTF-8");
  EXPECT_EQ(find_encoding("\xEF\xBB\xBFtime"), "UTF-8");
  EXPECT_EQ(find_encoding("I\xC2\xB7sa"), "UTF-8");
  EXPECT_EQ(find_encoding("cut off: \xC2"), "UTF-8");
  EXPECT_EQ(find_encoding("I\xB7sa (\xB5"
                          "A)"),
            "ISO-8859-1");
  EXPECT_EQ(find_encoding("T\x96"
                          "bus (\x80)"),
            "WINDOWS-1252");
  EXPECT_EQ(find_encoding("\x93\xFA\x8E\x9E,\x93\x64\x97\xAC[A],\x93\x64\x88\xB3[V]"), "SHIFT_JIS");
  EXPECT_EQ(find_encoding("\x93Strom\x94 \x85 \x96 I, \xE9tat"), "WINDOWS-1252");
  EXPECT_EQ(find_encoding("\xFF\xFEt\0i\0"s), "UTF-16LE");
  EXPECT_EQ(find_encoding("t\0i\0m\0e\0"s), "UTF-16LE");
  EXPECT_EQ(find_encoding("\0t\0i\0m\0e"s), "UTF-16BE");
}

TEST(TelemetryEncoding, OfWordsThatWesternEuropeHasNotIsAskedFor) {
  EXPECT_EQ(find_encoding("\xFF\xFE\0\0t\0\0\0"s), "UTF-32LE");
  for (const char* text : {
           "\xCA\xB1\xBC\xE4,u\n",                 // Chinese, GB18030
           "\xBD\xC3\xB0\xA3,\xC0\xFC\xB7\xF9\n",  // Korean, EUC-KR
           "\xAE\xC9\xB6\xA1,\xB9q\xACy,\xB9q\xC0\xA3\n\xA4U\xA4\xC8 1,\xA4U\xA4\xC8 2",  // Big5
           "\xC2\xF0\xE5\xEC\xFF;\xD2\xEE\xEA\n",  // Russian, Windows-1251
           "Czas;Pr\xB9"
           "d;Napi\xEA"
           "cie\n",  // Polish, Windows-1250
       })
    EXPECT_NE(foreign_word(text), "") << text;
  for (const char* text : {
           "Zeit;Gr\xF6\xDF"
           "e;Stra\xDF"
           "e;\xB5"
           "A;\xB0"
           "C;m\xB2",
           "Vibra\xE7\xE3o;Posi\xE7\xF5"
           "es",
           "M\xE4\xE4r\xE4;T\xE9l\xE9metrie cr\xE9\xE9"
           "e",
           "\x93Strom\x94 \x85 \x96 I",
       })
    EXPECT_EQ(foreign_word(text), "") << text;
}

TEST(TelemetryEncoding, OfAStreamIsConvertedWhereverItIsCut) {
  const std::string bytes =
      "I\xB7sa (\xB5"
      "A)";
  const std::string wide = "\xE9\0t\0\xE9\0"s;
  for (std::size_t cut = 0; cut <= wide.size(); ++cut) {
    std::string text;
    const auto decoder = Decoder::of("UTF-16LE");
    decoder->decode(wide.substr(0, cut), false, text);
    decoder->decode(wide.substr(cut), true, text);
    EXPECT_EQ(text, "\xC3\xA9t\xC3\xA9") << cut;
  }
  std::string text;
  Decoder::of("ISO-8859-1")->decode(bytes, true, text);
  EXPECT_EQ(text,
            "I\xC2\xB7sa (\xC2\xB5"
            "A)");
  text.clear();
  Decoder::of("WINDOWS-1252")->decode("a\x81z", true, text);
  EXPECT_EQ(text, "a\xEF\xBF\xBDz") << "a byte that the encoding does not know";
  EXPECT_EQ(Decoder::of("KLINGON"), nullptr);
}

TEST(TelemetryEncoding, OfPackedFilesIsNone) {
  const auto is_packed = [](std::string_view head) { return is_binary(head, find_encoding(head)); };
  EXPECT_TRUE(is_packed("\x1F\x8B\b"));
  EXPECT_TRUE(is_packed("PK\x03\x04"));
  EXPECT_TRUE(is_packed("PAR1\x15\x04\x15\x10 time,u\n1,2\n"));
  EXPECT_FALSE(is_packed("a,b\n1,2\n\0\0\0,4\n5,6\n7,8\n9,10\n"s)) << "a few NUL bytes are damage";
}

}  // namespace
}  // namespace reident::telemetry_file::encoding_test
