// Pictures as PNG keeps them: filtered rows (PNG specification, 9) in a zlib stream (RFC 1950 and
// 1951), without a search for repetitions but of a byte that repeats. Of rendered pictures nothing
// else repeats, and looking for it is most of the time that other encoders take. The bytes depend
// on the picture alone.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "../abi.h"

namespace {

constexpr int64_t LITERALS = 286;  // bytes, the end of a block, lengths of runs
constexpr int64_t END_OF_BLOCK = 256;
constexpr int64_t LONGEST_RUN = 258;
constexpr int64_t BLOCK_SYMBOLS = 1 << 15;

// First length of each code from 257 on, and how many bits tell the rest (RFC 1951, 3.2.5).
constexpr int RUN_FIRST[29] = {3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                               31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
constexpr int RUN_BITS[29] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                              2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};

struct Code {
    uint32_t bits = 0;  // as they are written, the first one lowest
    uint32_t length = 0;
};

// Symbols below 256 are bytes, others RUN + the length of a run of the byte before.
constexpr uint16_t RUN = 256;
constexpr int64_t SYMBOLS = RUN + LONGEST_RUN + 1;

class Bits {
public:
    Bits(uint8_t* out, uint8_t* end) : out_(out), end_(end) {}

    // At most 56 bits.
    void put(uint64_t bits, uint32_t length) {
        held_ |= bits << count_;
        count_ += length;
        spill();
    }
    // Writes what is left, filled up to a byte; returns where the stream ends, null if beyond.
    uint8_t* finish() {
        if (count_ > 0) {
            if (out_ >= end_) return nullptr;
            *out_++ = static_cast<uint8_t>(held_);
        }
        return full_ ? nullptr : out_;
    }

private:
    // Writes whole bytes. It always writes, as whether there are enough cannot be foreseen.
    void spill() {
        if (end_ - out_ < 8) {
            full_ = true;
            held_ = count_ = 0;
            return;
        }
        uint8_t* out = out_;
        const uint64_t held = held_;
        for (int byte = 0; byte < 8; byte++) out[byte] = static_cast<uint8_t>(held >> 8 * byte);
        out_ += count_ / 8;
        held_ >>= count_ & ~7u;
        count_ &= 7;
    }

    uint8_t* out_;
    uint8_t* end_;
    uint64_t held_ = 0;
    uint32_t count_ = 0;
    bool full_ = false;
};

// Huffman codes of symbols that are counted, none longer than `longest` bits: where one would be,
// counts are flattened until none is.
void make_codes(const uint32_t* counts, int64_t symbols, uint32_t longest, Code* codes) {
    struct Node {
        uint64_t count;
        int64_t parent;
    };
    std::vector<int64_t> used;
    for (int64_t symbol = 0; symbol < symbols; symbol++) {
        codes[symbol] = {};
        if (counts[symbol]) used.push_back(symbol);
    }
    const int64_t leaves = static_cast<int64_t>(used.size());
    if (leaves == 1) codes[used[0]].length = 1;
    for (uint32_t flat = 0; leaves > 1; flat++) {
        const auto weight = [&](int64_t symbol) { return (counts[symbol] >> flat) + 1u; };
        std::sort(used.begin(), used.end(), [&](int64_t a, int64_t b) {
            return weight(a) != weight(b) ? weight(a) < weight(b) : a < b;
        });
        std::vector<Node> nodes;
        nodes.reserve(static_cast<size_t>(2 * leaves));
        for (const int64_t symbol : used) nodes.push_back({weight(symbol), -1});
        // The two least, of leaves and joined ones, each in their order.
        int64_t leaf = 0, joined = leaves;
        const auto least = [&]() {
            const int64_t made = static_cast<int64_t>(nodes.size());
            const bool take_leaf =
                leaf < leaves && (joined >= made || nodes[static_cast<size_t>(leaf)].count <=
                                                        nodes[static_cast<size_t>(joined)].count);
            return take_leaf ? leaf++ : joined++;
        };
        for (int64_t join = 1; join < leaves; join++) {
            const int64_t one = least(), other = least();
            const int64_t parent = static_cast<int64_t>(nodes.size());
            nodes.push_back(
                {nodes[static_cast<size_t>(one)].count + nodes[static_cast<size_t>(other)].count,
                 -1});
            nodes[static_cast<size_t>(one)].parent = parent;
            nodes[static_cast<size_t>(other)].parent = parent;
        }
        std::vector<uint32_t> depth(nodes.size(), 0);
        uint32_t deepest = 0;
        for (int64_t node = static_cast<int64_t>(nodes.size()) - 2; node >= 0; node--) {
            const size_t place = static_cast<size_t>(node);
            depth[place] = depth[static_cast<size_t>(nodes[place].parent)] + 1;
            deepest = std::max(deepest, depth[place]);
        }
        if (deepest > longest) continue;
        for (int64_t place = 0; place < leaves; place++) {
            codes[used[static_cast<size_t>(place)]].length = depth[static_cast<size_t>(place)];
        }
        break;
    }
    uint32_t next = 0;
    for (uint32_t length = 1; length <= longest; length++, next <<= 1) {
        for (int64_t symbol = 0; symbol < symbols; symbol++) {
            if (codes[symbol].length != length) continue;
            uint32_t reversed = 0;
            for (uint32_t bit = 0; bit < length; bit++) {
                reversed |= ((next >> bit) & 1u) << (length - 1 - bit);
            }
            codes[symbol].bits = reversed;
            next++;
        }
    }
}

int run_code(int64_t length) {
    int code = 28;
    while (RUN_FIRST[code] > length) code--;
    return code;
}

// One block of symbols (RFC 1951, 3.2.7). The only distance is 1.
void put_block(Bits& stream, const uint16_t* symbols, int64_t count, bool last) {
    Bits bits = stream;  // what is written cannot lie in it
    // Of neighbours in tables of their own: equal ones need not wait for each other.
    uint32_t tables[4][SYMBOLS] = {};
    int64_t counted = 0;
    for (; counted + 4 <= count; counted += 4) {
        for (int k = 0; k < 4; k++) tables[k][symbols[counted + k]]++;
    }
    for (; counted < count; counted++) tables[0][symbols[counted]]++;
    uint32_t counts[LITERALS] = {};
    for (int64_t symbol = 0; symbol < SYMBOLS; symbol++) {
        const uint32_t found =
            tables[0][symbol] + tables[1][symbol] + tables[2][symbol] + tables[3][symbol];
        if (found) counts[symbol < RUN ? symbol : 257 + run_code(symbol - RUN)] += found;
    }
    counts[END_OF_BLOCK]++;
    Code codes[LITERALS];
    make_codes(counts, LITERALS, 15, codes);
    Code whole[SYMBOLS] = {};  // of runs: code, rest and distance in one
    std::copy_n(codes, RUN, whole);
    for (int64_t length = 4; length <= LONGEST_RUN; length++) {
        const int code = run_code(length);
        const Code own = codes[257 + code];
        const uint32_t rest = static_cast<uint32_t>(length - RUN_FIRST[code]);
        whole[RUN + length] = {own.bits | rest << own.length,
                               own.length + static_cast<uint32_t>(RUN_BITS[code]) + 1};
    }
    uint32_t length_counts[19] = {};
    length_counts[1]++;  // of the distance
    for (const Code& code : codes) length_counts[code.length]++;
    Code lengths[19];
    make_codes(length_counts, 19, 7, lengths);
    constexpr int ORDER[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    bits.put(last ? 1 : 0, 1);
    bits.put(2, 2);
    bits.put(LITERALS - 257, 5);
    bits.put(0, 5);       // one distance
    bits.put(19 - 4, 4);  // all lengths are told
    for (const int symbol : ORDER) bits.put(lengths[symbol].length, 3);
    for (const Code& code : codes) bits.put(lengths[code.length].bits, lengths[code.length].length);
    bits.put(lengths[1].bits, lengths[1].length);
    // No code is longer than 21 bits: two at once.
    int64_t place = 0;
    for (; place + 1 < count; place += 2) {
        const Code one = whole[symbols[place]], other = whole[symbols[place + 1]];
        bits.put(one.bits | static_cast<uint64_t>(other.bits) << one.length,
                 one.length + other.length);
    }
    if (place < count) bits.put(whole[symbols[place]].bits, whole[symbols[place]].length);
    bits.put(codes[END_OF_BLOCK].bits, codes[END_OF_BLOCK].length);
    stream = bits;
}

uint64_t eight_bytes(const uint8_t* data) {
    uint64_t bytes;
    memcpy(&bytes, data, 8);
    return bytes;
}

// Whether one of five bytes is like the one before it, and the next three are so, too.
bool has_run(const uint8_t* data) {
    constexpr uint64_t FIVE = 0xffffffffff;
    const uint64_t differs = eight_bytes(data) ^ eight_bytes(data - 1);
    const uint64_t two = differs | differs >> 8;
    const uint64_t four = (two | two >> 16) | ~FIVE;  // a byte is 0 where four of `differs` are
    return ((four - 0x0101010101010101u) & ~four & 0x8080808080808080u) != 0;
}

// Bytes to symbols; returns how many bytes were taken, and in `count` how many symbols were made.
int64_t take_symbols(const uint8_t* data, int64_t first, int64_t size, uint16_t* symbols,
                     int64_t& count) {
    int64_t place = first;
    count = 0;
    while (place < size && count < BLOCK_SYMBOLS) {
        if (place > 0 && size - place >= 8 && count + 8 <= BLOCK_SYMBOLS &&
            !has_run(data + place)) {
            for (int k = 0; k < 8; k++) symbols[count + k] = data[place + k];
            count += 5;
            place += 5;
            continue;
        }
        if (place > 0 && size - place >= 4) {
            const uint8_t before = data[place - 1];
            uint32_t next;
            memcpy(&next, data + place, 4);
            if (next == before * 0x01010101u) {
                int64_t end = place + 4;
                const int64_t most = std::min(size, place + LONGEST_RUN);
                while (end < most && data[end] == before) end++;
                symbols[count++] = static_cast<uint16_t>(RUN + end - place);
                place = end;
                continue;
            }
        }
        symbols[count++] = data[place++];
    }
    return place - first;
}

// Adler-32 (RFC 1950, 8.2). Each of 64 lanes adds up its bytes and these sums, for as long as both
// fit into 16 bits.
uint32_t adler_of(const uint8_t* data, int64_t size) {
    constexpr uint32_t MODULUS = 65521;
    constexpr int64_t LANES = 64, ROUNDS = 21;
    uint32_t a = 1, b = 0;
    int64_t first = 0;
    while (size - first >= LANES) {
        const int64_t rounds = std::min(ROUNDS, (size - first) / LANES);
        uint16_t sums[LANES] = {}, before[LANES] = {};
        for (int64_t round = 0; round < rounds; round++) {
            const uint8_t* own = data + first + round * LANES;
            for (int64_t lane = 0; lane < LANES; lane++) {
                before[lane] = static_cast<uint16_t>(before[lane] + sums[lane]);
                sums[lane] = static_cast<uint16_t>(sums[lane] + own[lane]);
            }
        }
        uint32_t sum = 0, weighted = 0;
        for (int64_t lane = 0; lane < LANES; lane++) {
            sum += sums[lane];
            weighted += static_cast<uint32_t>(LANES) * before[lane] +
                        static_cast<uint32_t>(LANES - lane) * sums[lane];
        }
        b = (b + a * static_cast<uint32_t>(rounds * LANES) + weighted) % MODULUS;
        a = (a + sum) % MODULUS;
        first += rounds * LANES;
    }
    for (; first < size; first++) {
        a = (a + data[first]) % MODULUS;
        b = (b + a) % MODULUS;
    }
    return b << 16 | a;
}

void filter_row(const uint8_t* row, const uint8_t* above, int64_t width, int64_t step, bool paeth,
                uint8_t* out) {
    const int64_t edge = std::min(step, width);
    for (int64_t x = 0; x < edge; x++) out[x] = static_cast<uint8_t>(row[x] - above[x]);
    for (int64_t x = edge; x < width && !paeth; x++) {
        out[x] = static_cast<uint8_t>(row[x] - above[x]);
    }
    for (int64_t x = edge; x < width && paeth; x++) {
        const int16_t left = row[x - step], up = above[x], corner = above[x - step];
        const int16_t to_left = static_cast<int16_t>(std::abs(up - corner));
        const int16_t to_up = static_cast<int16_t>(std::abs(left - corner));
        const int16_t to_corner = static_cast<int16_t>(std::abs(left + up - 2 * corner));
        const int16_t vertical = to_up <= to_corner ? up : corner;
        const int16_t near = to_left <= to_up && to_left <= to_corner ? left : vertical;
        out[x] = static_cast<uint8_t>(row[x] - near);
    }
}

int32_t png_data(const uint8_t* rows, int64_t height, int64_t width, int64_t step, bool paeth,
                 uint8_t* out, int64_t capacity, int64_t* written) {
    const int64_t size = height * (width + 1);
    std::unique_ptr<uint8_t[]> filtered(new uint8_t[static_cast<size_t>(size)]);
    const std::vector<uint8_t> nothing(static_cast<size_t>(width), 0);
    for (int64_t y = 0; y < height; y++) {
        uint8_t* to = filtered.get() + y * (width + 1);
        to[0] = paeth ? 4 : 2;
        const uint8_t* above = y == 0 ? nothing.data() : rows + (y - 1) * width;
        filter_row(rows + y * width, above, width, step, paeth, to + 1);
    }
    out[0] = 0x78;
    out[1] = 0x01;
    Bits bits(out + 2, out + capacity - 4);
    std::vector<uint16_t> symbols(BLOCK_SYMBOLS);
    for (int64_t first = 0; first < size;) {
        int64_t count = 0;
        first += take_symbols(filtered.get(), first, size, symbols.data(), count);
        put_block(bits, symbols.data(), count, first >= size);
    }
    uint8_t* end = bits.finish();
    if (end == nullptr) return sailenv::STATUS_OUT_OF_MEMORY;
    const uint32_t adler = adler_of(filtered.get(), size);
    for (int byte = 0; byte < 4; byte++) *end++ = static_cast<uint8_t>(adler >> (24 - 8 * byte));
    *written = end - out;
    return sailenv::STATUS_OK;
}

}  // namespace

// The content of a PNG file's IDAT chunk. `rows` (height, width) are bytes as the file has them,
// `step` of them a pixel; `paeth` filters by Paeth's predictor, else by the row above. `out` must
// hold twice the bytes of the picture and 4096; `written` takes how many were written.
SAILENV_KERNEL(png_data)
(const uint8_t* rows, int64_t height, int64_t width, int64_t step, int64_t paeth, uint8_t* out,
 int64_t capacity, int64_t* written) {
    constexpr int64_t LARGEST = int64_t{1} << 32;
    if (height < 1 || width < 1 || height > LARGEST / width || step < 1 || step > 8 ||
        capacity < 2 * height * (width + 1) + 4096) {
        return sailenv::STATUS_INVALID_ARGUMENT;
    }
    try {
        return png_data(rows, height, width, step, paeth != 0, out, capacity, written);
    } catch (const std::bad_alloc&) {
        return sailenv::STATUS_OUT_OF_MEMORY;
    }
}
