#pragma once

#include "recorded_formulas.hpp"

namespace {

// -------------------------------------------------------------------------------- 6 reading
//
// All numbers of the file are read in the default rounding mode, before upward rounding is set:
// decimals to the nearest double, as every other reader does, hexadecimal numbers exactly.

struct Json {
  enum Type { null, boolean, number, text, list, object } type = null;
  string string_value;  // Of a text; of a number, as it is written.
  double number_value = 0.0;
  vector<Json> items;    // Of a list; of an object, the values,
  vector<string> names;  // and their names, sorted.

  const Json* find(const string& name) const {
    const auto found = std::lower_bound(names.begin(), names.end(), name);
    if (found == names.end() || *found != name) return nullptr;
    return &items[static_cast<size_t>(found - names.begin())];
  }
};

[[noreturn]] void refuse(const string& why) { throw NotAProof{why}; }

// More than any gait's proof has of a thing: a text that asks for more work than this is refused before
// it is done. proof_file/limits.py has the same limits in the same words.
constexpr size_t kMostFields = 1000, kMostNames = 1000, kMostOutputs = 4000, kMostStatements = 1000,
                 kMostBoxes = 32, kMostOfOutput = 1000, kMostDimensions = 8, kMostSeries = 1000,
                 kMostLeaves = 8388608;
constexpr int kDeepest = 60;

void limit(size_t count, size_t most, const string& what) {
  if (count > most) refuse("more than " + std::to_string(most) + " " + what);
}

// A screen obeys some characters: no text of a proof file has them.
void refuse_control_characters(const string& text) {
  for (size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    if (byte < 0x20 || byte == 0x7F || (byte == 0xC2 && next < 0xA0))
      refuse("a text with a control character");
  }
}

// What is shown of what a file says may be as long as the file.
string shortened(const string& text) {
  constexpr size_t most = 600;
  return text.size() <= most ? text : text.substr(0, most) + " ...";
}

// A line on a screen: whatever is not plain ASCII is escaped, so that no text of a file, nor its path,
// can write over what this program says.
void say(const string& text, FILE* screen = stdout) {
  string line;
  char escape[8];
  for (const char c : text) {
    if (c >= 0x20 && c < 0x7F) { line += c; continue; }
    snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned char>(c));
    line += escape;
  }
  fprintf(screen, "%s\n", line.c_str());
}

class JsonReader {
 public:
  explicit JsonReader(const string& text) : text_(text) {}

  Json document() {
    Json value = element(0);
    space();
    if (at_ != text_.size()) refuse("text after the end of the JSON object");
    return value;
  }

 private:
  const string& text_;
  size_t at_ = 0;

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void space() {
    while (at_ < text_.size() && strchr(" \t\r\n", text_[at_]) && text_[at_]) ++at_;
  }
  void expect(const char* word) {
    if (text_.compare(at_, strlen(word), word) != 0)
      refuse("no JSON at byte " + std::to_string(at_));
    at_ += strlen(word);
  }

  Json element(int depth) {
    if (depth > kDeepest) limit(kDeepest + 1, kDeepest, "levels of JSON");
    space();
    Json value;
    switch (peek()) {
      case '{': fields(value, depth); break;
      case '[': entries(value, depth); break;
      case '"': value.type = Json::text; value.string_value = quoted(); break;
      case 't': expect("true"); value.type = Json::boolean; value.number_value = 1.0; break;
      case 'f': expect("false"); value.type = Json::boolean; break;
      case 'n': expect("null"); break;
      default: number(value);
    }
    return value;
  }

  void fields(Json& value, int depth) {
    value.type = Json::object;
    std::map<string, Json> found;
    expect("{");
    space();
    while (peek() != '}' || !found.empty()) {
      space();
      string name = quoted();
      if (found.count(name)) refuse("the field '" + name + "' twice in one object");
      limit(found.size() + 1, kMostFields, "fields in one object");
      space();
      expect(":");
      found.emplace(std::move(name), element(depth + 1));
      space();
      if (peek() == '}') break;
      expect(",");
    }
    expect("}");
    for (auto& [name, item] : found) {
      value.names.push_back(name);
      value.items.push_back(std::move(item));
    }
  }

  void entries(Json& value, int depth) {
    value.type = Json::list;
    expect("[");
    space();
    if (peek() == ']') { expect("]"); return; }
    while (true) {
      value.items.push_back(element(depth + 1));
      space();
      if (peek() == ']') { expect("]"); return; }
      expect(",");
    }
  }

  void digits() {
    if (!isdigit(static_cast<unsigned char>(peek())))
      refuse("no JSON at byte " + std::to_string(at_));
    while (isdigit(static_cast<unsigned char>(peek()))) ++at_;
  }

  void number(Json& value) {
    const size_t start = at_;
    if (peek() == '-') ++at_;
    if (peek() == '0') ++at_; else digits();
    if (peek() == '.') { ++at_; digits(); }
    if (peek() == 'e' || peek() == 'E') {
      ++at_;
      if (peek() == '+' || peek() == '-') ++at_;
      digits();
    }
    value.type = Json::number;
    value.string_value = text_.substr(start, at_ - start);
    const char* first = value.string_value.data();
    const auto end = std::from_chars(first, first + value.string_value.size(), value.number_value);
    if (end.ec != std::errc() || !(std::abs(value.number_value) < HUGE_VAL))
      refuse("the number " + value.string_value.substr(0, 40) + ", which no double is near");
  }

  unsigned hex4() {
    unsigned code = 0;
    for (int i = 0; i < 4; ++i, ++at_) {
      const char* place = peek() ? strchr("0123456789abcdef", tolower(peek())) : nullptr;
      if (!place) refuse("a broken escape in a JSON text");
      code = 16 * code + static_cast<unsigned>(place - "0123456789abcdef");
    }
    return code;
  }

  void utf8(string& out, unsigned code) {
    if (code < 0x80) {
      out += static_cast<char>(code);
    } else if (code < 0x800) {
      out += static_cast<char>(0xC0 | code >> 6);
      out += static_cast<char>(0x80 | (code & 63));
    } else if (code < 0x10000) {
      out += static_cast<char>(0xE0 | code >> 12);
      out += static_cast<char>(0x80 | (code >> 6 & 63));
      out += static_cast<char>(0x80 | (code & 63));
    } else {
      out += static_cast<char>(0xF0 | code >> 18);
      out += static_cast<char>(0x80 | (code >> 12 & 63));
      out += static_cast<char>(0x80 | (code >> 6 & 63));
      out += static_cast<char>(0x80 | (code & 63));
    }
  }

  string quoted() {
    expect("\"");
    string out;
    while (true) {
      if (at_ >= text_.size()) refuse("a JSON text without an end");
      const char c = text_[at_++];
      if (c == '"') {
        refuse_control_characters(out);
        return out;
      }
      if (static_cast<unsigned char>(c) < 0x20) refuse("a control character in a JSON text");
      if (c != '\\') { out += c; continue; }
      const char e = peek();
      ++at_;
      switch (e) {
        case '"': case '\\': case '/': out += e; break;
        case 'b': out += '\b'; break;
        case 'f': out += '\f'; break;
        case 'n': out += '\n'; break;
        case 'r': out += '\r'; break;
        case 't': out += '\t'; break;
        case 'u': {
          unsigned code = hex4();
          if (code >= 0xD800 && code < 0xDC00) {
            expect("\\u");
            const unsigned second = hex4();
            if (second < 0xDC00 || second > 0xDFFF) refuse("half a character in a JSON text");
            code = 0x10000 + ((code - 0xD800) << 10) + (second - 0xDC00);
          } else if (code >= 0xDC00 && code < 0xE000) {
            refuse("half a character in a JSON text");
          }
          utf8(out, code);
          break;
        }
        default: refuse("a broken escape in a JSON text");
      }
    }
  }
};

// An object with exactly these fields.
void only(const Json& table, const string& what, const vector<string>& names) {
  if (table.type != Json::object) refuse(what + " that is no JSON object");
  for (const string& name : names)
    if (!table.find(name)) refuse("no field '" + name + "' in " + what);
  const std::set<string> known(names.begin(), names.end());
  for (const string& name : table.names)
    if (!known.count(name)) refuse("unknown field '" + name + "' in " + what);
}

const Json& field(const Json& table, const string& what, const string& name) {
  const Json* value = table.type == Json::object ? table.find(name) : nullptr;
  if (!value) refuse("no field '" + name + "' in " + what);
  return *value;
}

string text_of(const Json& value, const string& what) {
  if (value.type != Json::text) refuse(what + " that is no text");
  return value.string_value;
}

const vector<Json>& list_of(const Json& value, const string& what) {
  if (value.type != Json::list) refuse(what + " that is no list");
  return value.items;
}

// A list of different names.
vector<string> names_of(const Json& value, const string& what) {
  vector<string> names;
  std::set<string> seen;
  limit(list_of(value, what).size(), kMostNames, what);
  for (const Json& item : list_of(value, what)) {
    names.push_back(text_of(item, "one of the " + what));
    if (!seen.insert(names.back()).second) refuse(names.back() + " twice among the " + what);
  }
  return names;
}

// A slash marks the premises of theorems: no condition and no region has one in its name.
void only_a_name(const string& name, const string& what) {
  if (name.empty() || name.front() == ' ' || name.back() == ' ')
    refuse("the name '" + name + "' of " + what + ", which is empty or ends in a space");
  if (name.size() > 200 || name.find("  ") != string::npos)
    refuse("the name '" + name.substr(0, 60) + "' of " + what + ", too long or with blanks in a row");
  if (name.find(',') != string::npos)
    refuse("the name '" + name + "' of " + what + ", which has a comma");
  if (name.find('/') != string::npos)
    refuse("the name '" + name + "' of " + what + ", which has a slash like a premise's");
}

double number_of(const Json& value, const string& what) {
  if (value.type != Json::number) refuse(what + " that is no number");
  return value.number_value;
}

int integer_of(const Json& value, const string& what) {
  const string& digits = value.string_value;
  if (value.type != Json::number || digits.size() > 9 || digits == "-0" ||
      digits.find_first_not_of("-0123456789") != string::npos)
    refuse(what + " that is no whole number");
  return static_cast<int>(value.number_value);
}

// [-]0x, 0 or 1, perhaps a point and up to 13 digits 0 to f, p, perhaps a sign, up to 4 digits: what is
// not exactly a double is none. Nothing else is read, so no two readers take one text for two numbers.
double hexadecimal(const Json& value, const string& what) {
  const string text = text_of(value, what);
  const string wrong = what + " '" + text.substr(0, 40) + "' instead of a hexadecimal number";
  size_t at = 0;
  const bool negative = at < text.size() && text[at] == '-';
  if (negative) ++at;
  if (text.compare(at, 2, "0x") != 0) refuse(wrong);
  at += 2;
  if (at >= text.size() || (text[at] != '0' && text[at] != '1')) refuse(wrong);
  std::uint64_t bits = text[at++] == '1';
  int exponent = 0, count = 0;
  if (at < text.size() && text[at] == '.') {
    for (++at; at < text.size() && text[at] != 'p'; ++at, ++count, exponent -= 4) {
      const char c = text[at];
      const bool known = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
      if (!known || count == 13) refuse(wrong);
      bits = bits << 4 | static_cast<std::uint64_t>(c <= '9' ? c - '0' : c - 'a' + 10);
    }
    if (count == 0) refuse(wrong);
  }
  if (at >= text.size() || text[at] != 'p') refuse(wrong);
  ++at;
  int sign = 1, power = 0;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) sign = text[at++] == '-' ? -1 : 1;
  if (at >= text.size() || text.size() - at > 4) refuse(wrong);
  for (; at < text.size(); ++at) {
    if (text[at] < '0' || text[at] > '9') refuse(wrong);
    power = 10 * power + (text[at] - '0');
  }
  exponent += sign * power;
  const double mantissa = static_cast<double>(bits), found = std::ldexp(mantissa, exponent);
  if (!(found < HUGE_VAL) || std::ldexp(found, -exponent) != mantissa) refuse(wrong);
  return negative ? -found : found;
}

vector<unsigned char> base64(const string& text, const string& what) {
  static const string alphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const string wrong = what + " whose data are no base64";
  if (text.size() % 4 != 0) refuse(wrong);
  vector<unsigned char> out;
  for (size_t start = 0; start < text.size(); start += 4) {
    std::uint32_t bits = 0;
    int padding = 0;
    for (size_t i = 0; i < 4; ++i) {
      const char c = text[start + i];
      const size_t place = alphabet.find(c);
      const bool last = start + 4 == text.size();
      if (c == '=' && last && i >= 2) ++padding;
      else if (place == string::npos || padding) refuse(wrong);
      bits = bits << 6 | static_cast<std::uint32_t>(c == '=' ? 0 : place);
    }
    if (padding && (bits & (padding == 1 ? 0xFFu : 0xFFFFu))) refuse(wrong);
    for (int i = 0; i < 3 - padding; ++i)
      out.push_back(static_cast<unsigned char>(bits >> (16 - 8 * i)));
  }
  return out;
}

// FIPS 180-4.
string sha256(const string& message) {
  static const std::uint32_t k[64] = {
      0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4,
      0xab1c5ed5, 0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe,
      0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f,
      0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7,
      0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc,
      0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85, 0xa2bfe8a1, 0xa81a664b,
      0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116,
      0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
      0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7,
      0xc67178f2};
  std::uint32_t h[8] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  const auto turn = [](std::uint32_t x, int n) { return x >> n | x << (32 - n); };
  string data = message + '\x80';
  while (data.size() % 64 != 56) data += '\0';
  for (int i = 7; i >= 0; --i)
    data += static_cast<char>(static_cast<std::uint64_t>(message.size()) * 8 >> (8 * i) & 255);
  for (size_t start = 0; start < data.size(); start += 64) {
    std::uint32_t w[64];
    for (size_t i = 0; i < 16; ++i) {
      w[i] = 0;
      for (size_t b = 0; b < 4; ++b)
        w[i] = w[i] << 8 | static_cast<unsigned char>(data[start + 4 * i + b]);
    }
    for (int i = 16; i < 64; ++i)
      w[i] = w[i - 16] + (turn(w[i - 15], 7) ^ turn(w[i - 15], 18) ^ w[i - 15] >> 3) + w[i - 7] +
             (turn(w[i - 2], 17) ^ turn(w[i - 2], 19) ^ w[i - 2] >> 10);
    std::uint32_t v[8];
    std::copy(h, h + 8, v);
    for (int i = 0; i < 64; ++i) {
      const std::uint32_t a = v[7] + (turn(v[4], 6) ^ turn(v[4], 11) ^ turn(v[4], 25)) +
                              ((v[4] & v[5]) ^ (~v[4] & v[6])) + k[i] + w[i];
      const std::uint32_t b = (turn(v[0], 2) ^ turn(v[0], 13) ^ turn(v[0], 22)) +
                              ((v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]));
      for (int j = 7; j > 0; --j) v[j] = v[j - 1];
      v[4] += a;
      v[0] = a + b;
    }
    for (int i = 0; i < 8; ++i) h[i] += v[i];
  }
  char out[65];
  for (int i = 0; i < 8; ++i) snprintf(out + 8 * i, 9, "%08x", h[i]);
  return out;
}

// A JSON text in ASCII: everything else as \uXXXX.
void ascii(const string& text, string& out) {
  out += '"';
  for (size_t at = 0; at < text.size();) {
    const unsigned char c = static_cast<unsigned char>(text[at++]);
    const int more = c < 0xC0 ? 0 : c < 0xE0 ? 1 : c < 0xF0 ? 2 : 3;
    unsigned code = more ? c & (63u >> more) : c;
    for (int i = 0; i < more; ++i) {
      if (at >= text.size()) refuse("a text that is no UTF-8");
      code = code << 6 | (static_cast<unsigned char>(text[at++]) & 63u);
    }
    static const std::map<unsigned, string> known = {{'"', "\\\""}, {'\\', "\\\\"}, {8, "\\b"},
        {9, "\\t"}, {10, "\\n"}, {12, "\\f"}, {13, "\\r"}};
    char escape[16];
    if (const auto found = known.find(code); found != known.end()) out += found->second;
    else if (code >= 0x20 && code < 0x7F) out += static_cast<char>(code);
    else if (code < 0x10000) { snprintf(escape, sizeof escape, "\\u%04x", code); out += escape; }
    else {
      snprintf(escape, sizeof escape, "\\u%04x\\u%04x", 0xD800 + ((code - 0x10000) >> 10 & 0x3FF),
               0xDC00 + ((code - 0x10000) & 0x3FF));
      out += escape;
    }
  }
  out += '"';
}

// The text that the Program's hash is of: names sorted, no spaces, ASCII.
void canonical(const Json& value, string& out) {
  switch (value.type) {
    case Json::null: out += "null"; break;
    case Json::boolean: out += value.number_value != 0.0 ? "true" : "false"; break;
    case Json::number:
      integer_of(value, "a number of the Program");
      out += value.string_value;
      break;
    case Json::text:
      ascii(value.string_value, out);
      break;
    case Json::list:
      out += '[';
      for (size_t i = 0; i < value.items.size(); ++i) {
        if (i) out += ',';
        canonical(value.items[i], out);
      }
      out += ']';
      break;
    case Json::object: {
      std::map<string, const Json*> sorted;
      for (size_t i = 0; i < value.names.size(); ++i) sorted[value.names[i]] = &value.items[i];
      out += '{';
      for (const auto& [name, item] : sorted) {
        if (out.back() != '{') out += ',';
        ascii(name, out);
        out += ':';
        canonical(*item, out);
      }
      out += '}';
    }
  }
}

// The shortest decimal that is this double.
string brief(double x) {
  char text[40];
  return string(text, std::to_chars(text, text + sizeof text, x).ptr);
}

}  // namespace
