// Pictures out of strangers' hands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include <fascia/base/error.h>
#include <fascia/base/random.h>
#include <fascia/io/picture/image.h>

namespace fascia {
namespace {

using testing::HasSubstr;

// A grey square of 8 x 8 points: tables of Huffman codes with one code each, and one block.
std::string greySquare() {
  std::string bytes("\xff\xd8", 2);
  bytes += std::string("\xff\xdb\x00\x43\x00", 5) + std::string(64, '\x10');
  bytes += std::string("\xff\xc0\x00\x0b\x08\x00\x08\x00\x08\x01\x01\x11\x00", 13);
  for (const char table : {'\x00', '\x10'})
    bytes += std::string("\xff\xc4\x00\x14", 4) + table + '\x01' + std::string(15, '\0') + '\0';
  bytes += std::string("\xff\xda\x00\x08\x01\x01\x00\x00\x3f\x00", 10);
  return bytes + std::string("\x3f\xff\xd9", 3);
}

std::string faultOf(std::string_view bytes) {
  try {
    decodeImage(bytes, "a.jpg");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Jpeg, IsRead) {
  const Image image = decodeImage(greySquare());
  ASSERT_EQ(image.width, 8);
  ASSERT_EQ(image.height, 8);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    EXPECT_EQ(image.rgba[i], 128);
    EXPECT_EQ(image.rgba[i + 3], 255);
  }
}

// More codes of a length than there are: what reads them without counting writes out of bounds.
TEST(Jpeg, WithMoreCodesThanThereAreIsRefused) {
  std::string bytes = greySquare();
  const std::size_t counts = bytes.find("\xff\xc4") + 5;
  for (std::size_t k = 0; k < 16; ++k) bytes[counts + k] = '\xff';
  EXPECT_THAT(faultOf(bytes), HasSubstr("a.jpg: not a good JPEG"));
}

TEST(Jpeg, OfASizeThatCannotBeIsRefusedBeforeItIsDecoded) {
  std::string bytes = greySquare();
  const std::size_t size = bytes.find("\xff\xc0") + 5;
  bytes.replace(size, 4, std::string("\xf0\x00\xf0\x00", 4));
  EXPECT_THAT(faultOf(bytes), HasSubstr("a.jpg: a picture of 61440 x 61440"));
  EXPECT_THROW(checkPicture(bytes, "a.jpg"), Error);
  EXPECT_NO_THROW(checkPicture(greySquare(), "a.jpg"));
}

TEST(Jpeg, CutShortIsRefused) {
  const std::string bytes = greySquare();
  for (std::size_t size = 3; size + 3 < bytes.size(); ++size)
    EXPECT_THAT(faultOf(bytes.substr(0, size)), HasSubstr("a.jpg: ")) << size;
}

TEST(Jpeg, DamagedIsAPictureOrAnError) {
  Random random(7);
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string bytes = greySquare();
    for (int k = 0; k < 3; ++k)
      bytes[3 + random.next() % (bytes.size() - 3)] = static_cast<char>(random.next());
    refused += faultOf(bytes).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 300);
}

TEST(Picture, ThatIsNoneIsNamed) {
  EXPECT_THAT(faultOf("nothing of the kind"), HasSubstr("a.jpg: neither a PNG nor a JPEG"));
  EXPECT_THROW(checkPicture("nothing of the kind"), Error);
}

}  // namespace
}  // namespace fascia
