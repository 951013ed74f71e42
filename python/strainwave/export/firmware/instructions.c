/* Calls a step of firmware with all rows of the file "inputs", and writes the file "counts": how long each call took in ticks of
   the system timer, and what Counts holds. QEMU lets 1 ns pass with each instruction, so that a tick of 40 ns is 40 instructions.
   Without an operating system: a table of vectors, and files by semihosting. */
#include <string.h>

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define INPUTS JOIN(NAME, _inputs)
#define STATE JOIN(NAME, _state)
#define OUTPUTS JOIN(NAME, _outputs)

#define DEPTH 65536 /* bytes of stack that are looked at */
#define PAINT 0xA5
#define REPEATED_STEPS 1000
#define KINDS 3 /* of a step: a shaft sticks; both slip; a shaft stops, breaks away or turns round */
#define TIMER ((volatile unsigned*)0xE000E010)
#define TICKS 0xFFFFFFu

struct Counts {
    unsigned steps, depth; /* bytes of stack, in the longest steps */
    unsigned empty;        /* ticks of `REPEATED_STEPS` calls of a function of one instruction, each measured by itself */
    unsigned found[KINDS], repeated[KINDS], idle[KINDS]; /* steps, ticks of repeats of the longest, and of the loop alone */
};
typedef OUTPUTS (*Step)(STATE*, const INPUTS*);

static struct Counts counts;
static INPUTS* const inputs = (INPUTS*)0x21000000; /* the large memory of the machine */
static unsigned* const ticks = (unsigned*)0x21800000;
static STATE state, before, longest[KINDS];
static INPUTS input[KINDS];
static volatile OUTPUTS last;

static int ask(int operation, const void* argument) {
    register int r0 __asm__("r0") = operation;
    register const void* r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}
static int opened(const char* name, int mode) {
    const int request[] = {(int)name, mode, (int)strlen(name)};
    return ask(1, request);
}

__attribute__((naked)) static OUTPUTS nothing(STATE* at, const INPUTS* in) { __asm__("bx lr"); }
static unsigned now(void) { return TIMER[2]; }

__attribute__((noinline)) static unsigned repeats(Step volatile function, int kind) {
    const unsigned begin = now();
    for (int i = 0; i < REPEATED_STEPS; ++i) {
        state = longest[kind];
        last = function(&state, &input[kind]);
    }
    return (begin - now()) & TICKS;
}
/* The random delay puts the call anywhere within a tick, so that rounding to ticks averages out. */
__attribute__((noinline)) static unsigned timed(Step volatile function, const INPUTS* in, unsigned k) {
    for (unsigned i = (k * 2654435761u >> 20) % 40 + 1; i > 0; --i) __asm__ volatile("nop");
    const unsigned begin = now();
    last = function(&state, in);
    return (begin - now()) & TICKS;
}

__attribute__((noinline)) static void run(void) { /* inlined, it would use the floating-point unit before that is on */
    unsigned most[KINDS] = {0};
    JOIN(NAME, _start)(&state);
    for (unsigned k = 0; k < counts.steps; ++k) {
        before = state;
        const float first = INPUT_DIRECTION, second = OUTPUT_DIRECTION;
        ticks[k] = timed(JOIN(NAME, _step), &inputs[k], k);
        const int turns = first != INPUT_DIRECTION || second != OUTPUT_DIRECTION;
        const int kind = turns ? 2 : first != 0.0f && second != 0.0f;
        ++counts.found[kind];
        if (ticks[k] <= most[kind]) continue;
        most[kind] = ticks[k];
        longest[kind] = before;
        input[kind] = inputs[k];
    }
}

__attribute__((noinline)) static void paint(void) {
    volatile unsigned char mark, *const deepest = &mark - DEPTH;
    for (unsigned k = 0; k < DEPTH - 32; ++k) deepest[k] = PAINT;
}
/* Bytes of stack that were touched since it was painted. */
__attribute__((noinline)) static unsigned painted_over(void) {
    volatile unsigned char mark, *const deepest = &mark - DEPTH;
    unsigned depth = DEPTH;
    for (const volatile unsigned char* at = deepest; *at == PAINT; ++at) --depth;
    return depth;
}

void steps(void) {
    *(volatile unsigned*)0xE000ED88 |= 0xFu << 20; /* the floating-point unit is off after a reset */
    __asm__ volatile("dsb\n\tisb");
    TIMER[1] = TICKS;
    TIMER[0] = 5; /* on, by the clock of the processor */
    const int from = opened("inputs", 1), size = ask(0xC, &from);
    const int reading[] = {from, (int)inputs, size};
    ask(6, reading);
    counts.steps = (unsigned)size / sizeof *inputs;
    run();
    paint();
    for (unsigned i = 0; i < REPEATED_STEPS; ++i) counts.empty += timed(nothing, inputs, i);
    counts.depth = 0u - painted_over();
    paint();
    for (int kind = 0; kind < KINDS; ++kind) {
        if (counts.found[kind] == 0) continue;
        counts.repeated[kind] = repeats(JOIN(NAME, _step), kind);
        state = longest[kind];
        timed(JOIN(NAME, _step), &input[kind], 0);
    }
    counts.depth += painted_over();
    for (int kind = 0; kind < KINDS; ++kind)
        if (counts.found[kind] > 0) counts.idle[kind] = repeats(nothing, kind);
    const int to = opened("counts", 5);
    const int head[] = {to, (int)&counts, sizeof counts}, rest[] = {to, (int)ticks, (int)(counts.steps * sizeof *ticks)};
    ask(5, head);
    ask(5, rest);
    ask(0x18, (const void*)0x20026); /* SYS_EXIT */
}

__attribute__((section(".vectors"), used)) static const void* const vectors[] = {(void*)0x20100000, (void*)steps};
