// Inflates streams of the deflate format (RFC 1951). Any that keeps the rules to the letter is
// read; blocks of many single bytes and runs of one byte, as png_data.cpp writes them, are read
// quickest.
#pragma once

#include <cstdint>
#include <cstring>

#include "png_stream.h"

namespace inflating {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "bits and bytes are read several at once");

constexpr uint32_t END_OF_BLOCK = 256;
constexpr uint32_t LONGEST_CODE = 15;

constexpr int DISTANCE_FIRST[30] = {1,    2,    3,    4,    5,    7,    9,    13,    17,    25,
                                    33,   49,   65,   97,   129,  193,  257,  385,   513,   769,
                                    1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
constexpr int DISTANCE_BITS[30] = {0, 0, 0, 0, 1, 1, 2, 2,  3,  3,  4,  4,  5,  5,  6,
                                   6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13};

// What the next bits stand for. From the lowest bit on: 6 of how many bits that are, 2 of how many
// bytes follow from them (0 to 3), then the bytes; or else 16 bits of a number, 4 of how many bits
// are added to it, and what it is.
using Entry = uint32_t;
enum Kind : uint32_t { NOTHING = 0, NUMBER = 1, END = 2, LONGER = 3 };

constexpr Entry byte_entry(uint32_t byte) { return 1u << 6 | byte << 8; }
constexpr Entry entry(Kind kind, uint32_t number, uint32_t bits) {
    return number << 8 | bits << 24 | static_cast<uint32_t>(kind) << 28;
}
constexpr uint32_t length_of(Entry e) { return e & 63; }
constexpr uint32_t bytes_of(Entry e) { return e >> 6 & 3; }
constexpr uint32_t number_of(Entry e) { return e >> 8 & 0xffff; }
constexpr uint32_t more_bits_of(Entry e) { return e >> 24 & 15; }
constexpr uint32_t kind_of(Entry e) { return e >> 28; }

constexpr uint32_t reversed(uint32_t x) {
    x = (x & 0x5555) << 1 | (x >> 1 & 0x5555);
    x = (x & 0x3333) << 2 | (x >> 2 & 0x3333);
    x = (x & 0x0f0f) << 4 | (x >> 4 & 0x0f0f);
    return (x & 0xff) << 8 | x >> 8;
}

// Looks up codes by the next BITS bits; longer ones once more, by the bits behind these.
template <uint32_t BITS, int SYMBOLS>
struct Table {
    static constexpr uint32_t SIZE = 1u << BITS, REST = LONGEST_CODE - BITS;
    // Where a code is longer, so is another that begins like it.
    Entry entries[SIZE + (SYMBOLS / 2 << REST)];

    // `meanings` have no length yet. False if the lengths do not make a code. One may lack in which
    // half of what one bit can say has no meaning, or all of it.
    bool fill(const uint8_t* lengths, int symbols, const Entry* meanings, bool may_lack) {
        uint32_t counts[LONGEST_CODE + 1] = {}, firsts[LONGEST_CODE + 2] = {};
        for (int symbol = 0; symbol < symbols; symbol++) counts[lengths[symbol]]++;
        counts[0] = 0;
        uint32_t used = 0;
        for (uint32_t length = 1; length <= LONGEST_CODE; length++) {
            used += counts[length] << (LONGEST_CODE - length);
            firsts[length + 1] = firsts[length] + counts[length];
        }
        constexpr uint32_t FULL = 1u << LONGEST_CODE;
        const bool lacks = used == 0 || (used == FULL / 2 && counts[1] == 1);
        if (used != FULL && !(may_lack && lacks)) return false;
        Entry ordered[SYMBOLS];
        for (int symbol = 0; symbol < symbols; symbol++) {
            const uint32_t length = lengths[symbol];
            if (length > 0) ordered[firsts[length]++] = meanings[symbol] | length;
        }
        // Of bits that are read, the first one is lowest: a table of one bit more is twice that of
        // one bit less, besides the codes of this length.
        const Entry* next = ordered;
        uint32_t code = 0;
        entries[0] = 0;
        for (uint32_t length = 1; length <= BITS; length++) {
            const uint32_t half = 1u << (length - 1);
            memcpy(entries + half, entries, half * sizeof(Entry));
            code <<= 1;
            for (uint32_t k = 0; k < counts[length]; k++) {
                entries[reversed(code++) >> (16 - length)] = *next++;
            }
        }
        uint32_t end = SIZE, open = SIZE, place = 0;  // of the codes of one prefix; none is open
        for (uint32_t length = BITS + 1; length <= LONGEST_CODE; length++) {
            code <<= 1;
            for (uint32_t k = 0; k < counts[length]; k++, next++) {
                const uint32_t bits = reversed(code++) >> (16 - length);
                // Codes come in order: those of one prefix follow each other.
                if (open != (bits & (SIZE - 1))) {
                    open = bits & (SIZE - 1);
                    place = end;
                    entries[open] = entry(LONGER, place, 0) | BITS;
                    end += 1u << REST;
                }
                for (uint32_t own = bits >> BITS; own < 1u << REST; own += 1u << (length - BITS)) {
                    entries[place + own] = *next;
                }
            }
        }
        return true;
    }

    // Makes a table of up to three bytes at once, where their codes are short enough. Without
    // branches, as whether they are cannot be foreseen.
    void join(Entry* __restrict joined) const {
        for (uint32_t place = 0; place < SIZE; place++) {
            const Entry one = entries[place];
            const Entry two = entries[place >> (one & 15)];
            const uint32_t both = (one & 31) + (two & 31);
            const Entry three = entries[place >> (both & 31)];
            const uint32_t all = both + (three & 31);
            const uint32_t has_two = (one & two) >> 6 & (both <= BITS ? 1u : 0u);
            const uint32_t has_three = has_two & three >> 6 & (all <= BITS ? 1u : 0u);
            joined[place] = one + (((two & 0xff00u) << 8) + (two & 0xffu)) * has_two +
                            (((three & 0xff00u) << 16) + (three & 0xffu)) * has_three;
        }
    }

    Entry longer(Entry e, uint64_t bits) const {
        return entries[number_of(e) + (bits >> BITS & ((1u << REST) - 1))];
    }
};

// Reads bits, the lowest of each byte first. At the end it reads zeros, and tells so.
class BitReader {
public:
    BitReader(const uint8_t* data, const uint8_t* end) : data_(data), end_(end) {}

    // Afterwards 56 bits are held, or all there are.
    void refill() {
        if (end_ - data_ >= 8) {
            uint64_t next;
            memcpy(&next, data_, 8);
            held_ |= next << count_;
            data_ += (63 - count_) >> 3;
            count_ |= 56;
            return;
        }
        while (count_ < 56 && data_ < end_) {
            held_ |= static_cast<uint64_t>(*data_++) << count_;
            count_ += 8;
        }
    }
    uint64_t peek() const { return held_; }
    void drop(uint32_t bits) {
        held_ >>= bits;
        count_ -= bits;
    }
    uint32_t take(uint32_t bits) {
        const uint32_t taken = static_cast<uint32_t>(held_ & ((uint64_t{1} << bits) - 1));
        drop(bits);
        return taken;
    }
    // Whether more was taken than there is.
    bool is_beyond() const { return count_ > 64; }
    // Goes on at the next whole byte, and gives back what was held.
    const uint8_t* align() {
        drop(count_ & 7);
        data_ -= count_ >> 3;
        held_ = count_ = 0;
        return data_;
    }
    const uint8_t* end() const { return end_; }
    void skip(int64_t bytes) { data_ += bytes; }

private:
    const uint8_t* data_;
    const uint8_t* end_;
    uint64_t held_ = 0;
    uint32_t count_ = 0;
};

class Inflater {
public:
    Inflater(const uint8_t* data, const uint8_t* end, uint8_t* out, uint8_t* out_end)
        : bits_(data, end), begin_(out), out_(out), out_end_(out_end) {
        for (uint32_t byte = 0; byte < 256; byte++) of_symbols_[byte] = byte_entry(byte);
        of_symbols_[END_OF_BLOCK] = entry(END, 0, 0);
        for (int code = 0; code < 29; code++) {
            of_symbols_[257 + code] = entry(NUMBER, static_cast<uint32_t>(RUN_FIRST[code]),
                                            static_cast<uint32_t>(RUN_BITS[code]));
        }
        for (int code = 0; code < 30; code++) {
            of_distances_[code] = entry(NUMBER, static_cast<uint32_t>(DISTANCE_FIRST[code]),
                                        static_cast<uint32_t>(DISTANCE_BITS[code]));
        }
    }

    // Whether all blocks could be read, and fill the output to its end.
    bool inflate() {
        for (bool last = false; !last;) {
            bits_.refill();
            last = bits_.take(1) != 0;
            const uint32_t kind = bits_.take(2);
            const bool good = kind == 0   ? copy_stored()
                              : kind == 1 ? plain_codes()
                              : kind == 2 ? read_codes()
                                          : false;
            if (!good || (kind != 0 && !decode()) || bits_.is_beyond()) return false;
        }
        return out_ == out_end_;
    }

    // What follows the stream.
    const uint8_t* rest() { return bits_.align(); }

private:
    bool copy_stored() {
        if (bits_.is_beyond()) return false;
        const uint8_t* data = bits_.align();
        if (bits_.end() - data < 4) return false;
        const int64_t size = data[0] | data[1] << 8, inverse = data[2] | data[3] << 8;
        if ((size ^ inverse) != 0xffff || bits_.end() - data < 4 + size || out_end_ - out_ < size) {
            return false;
        }
        memcpy(out_, data + 4, static_cast<size_t>(size));
        out_ += size;
        bits_.skip(4 + size);
        return true;
    }

    bool plain_codes() {
        uint8_t lengths[288 + 32];
        for (int symbol = 0; symbol < 288; symbol++) {
            lengths[symbol] = symbol < 144 ? 8 : symbol < 256 ? 9 : symbol < 280 ? 7 : 8;
        }
        memset(lengths + 288, 5, 32);
        if (!symbols_.fill(lengths, 288, of_symbols_, false)) return false;
        symbols_.join(joined_);
        return distances_.fill(lengths + 288, 32, of_distances_, false);
    }

    bool read_codes() {
        const int symbols = static_cast<int>(bits_.take(5)) + 257;
        const int distances = static_cast<int>(bits_.take(5)) + 1;
        const int told = static_cast<int>(bits_.take(4)) + 4;
        if (symbols > 286 || distances > 30) return false;
        uint8_t own[19] = {};
        for (int k = 0; k < told; k++) {
            bits_.refill();
            own[LENGTH_ORDER[k]] = static_cast<uint8_t>(bits_.take(3));
        }
        Entry meanings[19];
        for (uint32_t k = 0; k < 19; k++) meanings[k] = entry(NUMBER, k, 0);
        if (!lengths_.fill(own, 19, meanings, false)) return false;
        uint8_t lengths[286 + 30 + 138];
        for (int k = 0; k < symbols + distances;) {
            bits_.refill();
            const Entry e = lengths_.entries[bits_.peek() & (lengths_.SIZE - 1)];
            bits_.drop(length_of(e));
            const uint32_t symbol = number_of(e);
            if (symbol < 16) {
                lengths[k++] = static_cast<uint8_t>(symbol);
                continue;
            }
            if (symbol == 16 && k == 0) return false;
            const uint8_t value = symbol == 16 ? lengths[k - 1] : 0;
            const uint32_t times = symbol == 16   ? 3 + bits_.take(2)
                                   : symbol == 17 ? 3 + bits_.take(3)
                                                  : 11 + bits_.take(7);
            memset(lengths + k, value, times);
            k += static_cast<int>(times);
            if (k > symbols + distances) return false;
        }
        if (bits_.is_beyond() || lengths[END_OF_BLOCK] == 0) return false;
        if (!symbols_.fill(lengths, symbols, of_symbols_, false)) return false;
        symbols_.join(joined_);
        return distances_.fill(lengths + symbols, distances, of_distances_, true);
    }

    // The symbols of one block.
    bool decode() {
        BitReader bits = bits_;  // what is written cannot lie in it
        uint8_t* out = out_;
        uint8_t* const out_end = out_end_;
        bool good = false;
        for (;;) {
            bits.refill();
            Entry e = joined_[bits.peek() & (symbols_.SIZE - 1)];
            // Three times at most 11 bits, and up to three bytes, of which four are written.
            if (out_end - out >= 16) {
                for (int k = 0; k < 3 && bytes_of(e); k++) {
                    const uint32_t bytes = e >> 8;
                    memcpy(out, &bytes, 4);
                    out += bytes_of(e);
                    bits.drop(length_of(e));
                    e = joined_[bits.peek() & (symbols_.SIZE - 1)];
                }
                if (bytes_of(e)) continue;
                bits.refill();
            }
            if (!bytes_of(e) && kind_of(e) == LONGER) e = symbols_.longer(e, bits.peek());
            bits.drop(length_of(e));
            if (bytes_of(e)) {
                if (out_end - out < bytes_of(e)) break;
                for (uint32_t k = 0; k < bytes_of(e); k++) {
                    *out++ = static_cast<uint8_t>(e >> (8 + 8 * k));
                }
                if (bits.is_beyond()) break;
                continue;
            }
            if (kind_of(e) != NUMBER) {
                good = kind_of(e) == END;
                break;
            }
            const int64_t size = number_of(e) + bits.take(more_bits_of(e));
            Entry far = distances_.entries[bits.peek() & (distances_.SIZE - 1)];
            if (kind_of(far) == LONGER) far = distances_.longer(far, bits.peek());
            if (kind_of(far) != NUMBER) break;
            bits.drop(length_of(far));
            const int64_t distance = number_of(far) + bits.take(more_bits_of(far));
            if (distance > out - begin_ || size > out_end - out || bits.is_beyond()) break;
            repeat(out, distance, size);
            out += size;
        }
        bits_ = bits;
        out_ = out;
        return good;
    }

    void repeat(uint8_t* out, int64_t distance, int64_t size) const {
        if (distance == 1 && out_end_ - out >= size + 8) {
            // Most are short.
            const uint64_t bytes = out[-1] * uint64_t{0x0101010101010101};
            for (int64_t k = 0; k < size; k += 8) memcpy(out + k, &bytes, 8);
        } else if (distance >= size) {
            memcpy(out, out - distance, static_cast<size_t>(size));
        } else {
            for (int64_t k = 0; k < size; k++) out[k] = out[k - distance];
        }
    }

    BitReader bits_;
    uint8_t* begin_;
    uint8_t* out_;
    uint8_t* out_end_;
    Table<11, 288> symbols_;
    Entry joined_[Table<11, 288>::SIZE];
    Table<9, 32> distances_;
    Table<7, 19> lengths_;
    Entry of_symbols_[288] = {};
    Entry of_distances_[32] = {};
};

}  // namespace inflating
