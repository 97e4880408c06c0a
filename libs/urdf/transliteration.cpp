// SPDX-License-Identifier: Apache-2.0
#include "urdf/transliteration.h"

#include <fmt/format.h>

#include <cstdint>
#include <optional>

namespace slew::urdf {
namespace {

// letters of a block in the order of Unicode, separated by spaces; - is no letter
struct Block {
  std::uint32_t first, last;
  std::string_view letters;
};

constexpr Block kLatin{
    0xC0, 0x17F,
    "A A A A Ae A AE C E E E E I I I I D N O O O O Oe x O U U U Ue Y Th ss a a a a ae a ae c e e e e i i i i "
    "d n o o o o oe _ o u u u ue y th y A a A a A a C c C c C c C c D d D d E e E e E e E e E e G g G g G g "
    "G g H h H h I i I i I i I i I i IJ ij J j K k k L l L l L l L l L l N n N n N n n Ng ng O o O o O o OE "
    "oe R r R r R r S s S s S s S s T t T t T t U u U u U u U u U u U u W w Y y Y Z z Z z Z z s"};
constexpr Block kGreek{
    0x386, 0x3CE,
    "A _ E I I _ O _ Y O i A V G D E Z I Th I K L M N X O P R _ S T Y F Ch Ps O I Y a e i i y a v g d e z i "
    "th i k l m n x o p r s s t y f ch ps o i y o y o"};
constexpr Block kCyrillic{
    0x400, 0x45F,
    "E Yo Dj G Ye Dz I Yi J Lj Nj C K I U Dzh A B V G D E Zh Z I J K L M N O P R S T U F Kh Ts Ch Sh Shch - "
    "Y - E Yu Ya a b v g d e zh z i j k l m n o p r s t u f kh ts ch sh shch - y - e yu ya e yo dj g ye dz i "
    "yi j lj nj c k i u dzh"};
constexpr Block kKatakana{
    0x30A1, 0x30F6,
    "a a i i u u e e o o ka ga ki gi ku gu ke ge ko go sa za shi ji su zu se ze so zo ta da chi ji tsu tsu "
    "zu te de to do na ni nu ne no ha ba pa hi bi pi fu bu pu he be pe ho bo po ma mi mu me mo ya ya yu yu "
    "yo yo ra ri ru re ro wa wa wi we wo n vu ka ke"};
constexpr std::uint32_t kFromHiragana = 0x60;  // 0x3041 to 0x3096 are the same letters
constexpr std::uint32_t kLongVowel = 0x30FC;

constexpr Block kHangulInitials{0, 18, "g kk n d tt r m b pp s ss - j jj ch k t p h"};
constexpr Block kHangulVowels{0, 20, "a ae ya yae eo e yeo ye o wa wae oe yo u wo we wi yu eu ui i"};
constexpr Block kHangulFinals{0, 27, "- k k k n n n t l k m l l l p l m p p t t ng t t k t p t"};
constexpr std::uint32_t kFirstHangul = 0xAC00, kLastHangul = 0xD7A3;

std::string_view letter_of(const Block& block, std::uint32_t code) {
  std::string_view rest = block.letters;
  for (std::uint32_t skipped = block.first; skipped < code; ++skipped) rest.remove_prefix(rest.find(' ') + 1);
  const std::string_view letter = rest.substr(0, rest.find(' '));
  return letter == "-" ? std::string_view() : letter;
}

std::string hangul(std::uint32_t code) {
  const std::uint32_t place = code - kFirstHangul;
  std::string syllable(letter_of(kHangulInitials, place / 588));
  syllable += letter_of(kHangulVowels, place / 28 % 21);
  syllable += letter_of(kHangulFinals, place % 28);
  return syllable;
}

std::string romanised(std::uint32_t code) {
  for (const Block& block : {kLatin, kGreek, kCyrillic, kKatakana}) {
    if (code >= block.first && code <= block.last) return std::string(letter_of(block, code));
  }
  const std::uint32_t katakana = code + kFromHiragana;
  if (code < kKatakana.first && katakana >= kKatakana.first && katakana <= kKatakana.last) return romanised(katakana);
  if (code >= kFirstHangul && code <= kLastHangul) return hangul(code);
  const bool is_mark = code >= 0x300 && code <= 0x36F;
  if (is_mark || code == kLongVowel) return "";
  return fmt::format("u{:04X}", code);
}

// Removes and returns one character; nothing if the bytes are no UTF-8, then one byte is removed.
std::optional<std::uint32_t> take_character(std::string_view& text) {
  const auto first = static_cast<unsigned char>(text.front());
  text.remove_prefix(1);
  const std::size_t more = first < 0x80   ? 0
                           : first < 0xC2 ? 4
                           : first < 0xE0 ? 1
                           : first < 0xF0 ? 2
                           : first < 0xF5 ? 3
                                          : 4;
  if (more == 4 || more > text.size()) return std::nullopt;
  std::uint32_t code = more == 0 ? first : first & (0x3FU >> more);
  for (std::size_t k = 0; k < more; ++k) {
    const auto next = static_cast<unsigned char>(text[k]);
    if ((next & 0xC0U) != 0x80U) return std::nullopt;
    code = code << 6U | (next & 0x3FU);
  }
  text.remove_prefix(more);
  return code;
}

}  // namespace

std::string in_ascii(std::string_view utf8) {
  std::string ascii;
  while (!utf8.empty()) {
    const std::optional<std::uint32_t> code = take_character(utf8);
    if (code && *code < 0x80) {
      ascii += static_cast<char>(*code);
    } else {
      ascii += code ? romanised(*code) : "_";
    }
  }
  return ascii;
}

}  // namespace slew::urdf
