/* Counts what a program executes between two of its own functions, exactly, under QEMU: a plugin for its translator.
 *
 *     qemu-system-arm ... -plugin count.so,begin=0x4a8,end=0x4b4
 *
 * An interval runs from the first instruction at `begin` to the next one at `end`. At the end of the program it prints,
 * over all intervals, how many there were, the mean, fewest and most instructions, and the deepest stack: from
 * the first store of an interval, which `begin` makes, to the lowest one.
 *
 * Debian packages no header for plugins; what is used of version 1 of the interface, which QEMU 4.2 to 8 offer,
 * is declared here.
 */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t plugin_id;
struct tb;
struct insn;
void qemu_plugin_register_vcpu_tb_trans_cb(plugin_id, void (*)(plugin_id, struct tb *));
size_t qemu_plugin_tb_n_insns(const struct tb *);
struct insn *qemu_plugin_tb_get_insn(const struct tb *, size_t);
uint64_t qemu_plugin_insn_vaddr(const struct insn *);
void qemu_plugin_register_vcpu_insn_exec_cb(struct insn *, void (*)(unsigned, void *), int flags, void *);
void qemu_plugin_register_vcpu_mem_cb(struct insn *, void (*)(unsigned, uint32_t, uint64_t, void *), int flags, int kind, void *);
void qemu_plugin_register_atexit_cb(plugin_id, void (*)(plugin_id, void *), void *);

enum { NO_REGISTERS = 0, STORES = 2 };

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

static uint64_t begin, end;
static bool counting;
static uint64_t count, top, bottom;
static uint64_t intervals, total, fewest = UINT64_MAX, most, deepest;

static void started(unsigned cpu, void *data)
{
    (void)cpu, (void)data;
    counting = true;
    count = 1;
    top = bottom = 0;
}

static void executed(unsigned cpu, void *data)
{
    (void)cpu, (void)data;
    count += counting;
}

static void ended(unsigned cpu, void *data)
{
    (void)cpu, (void)data;
    if (!counting)
        return;
    counting = false;
    intervals++;
    total += count;
    fewest = count < fewest ? count : fewest;
    most = count > most ? count : most;
    deepest = top - bottom > deepest ? top - bottom : deepest;
}

static void stored(unsigned cpu, uint32_t what, uint64_t address, void *data)
{
    (void)cpu, (void)what, (void)data;
    if (!counting)
        return;
    if (top == 0)
        top = bottom = address;
    /* What lies far away is no stack. */
    if (address < bottom && bottom - address < 0x2000)
        bottom = address;
}

static void translated(plugin_id id, struct tb *tb)
{
    (void)id;
    for (size_t i = 0; i < qemu_plugin_tb_n_insns(tb); i++) {
        struct insn *insn = qemu_plugin_tb_get_insn(tb, i);
        uint64_t address = qemu_plugin_insn_vaddr(insn);
        void (*call)(unsigned, void *) = address == begin ? started : address == end ? ended : executed;
        qemu_plugin_register_vcpu_insn_exec_cb(insn, call, NO_REGISTERS, NULL);
        qemu_plugin_register_vcpu_mem_cb(insn, stored, NO_REGISTERS, STORES, NULL);
    }
}

static void report(plugin_id id, void *data)
{
    (void)id, (void)data;
    char line[160];
    snprintf(line, sizeof line, "intervals %" PRIu64 " mean %.1f fewest %" PRIu64 " most %" PRIu64 " stack %" PRIu64 "\n",
             intervals, intervals ? (double)total / (double)intervals : 0.0, intervals ? fewest : 0, most, deepest);
    fprintf(stderr, "%s", line);
}

__attribute__((visibility("default"))) int qemu_plugin_install(plugin_id id, const void *info, int argc, char **argv)
{
    (void)info;
    for (int i = 0; i < argc; i++) {
        if (strncmp(argv[i], "begin=", 6) == 0)
            begin = strtoull(argv[i] + 6, NULL, 16) & ~UINT64_C(1); /* An odd address says Thumb. */
        if (strncmp(argv[i], "end=", 4) == 0)
            end = strtoull(argv[i] + 4, NULL, 16) & ~UINT64_C(1);
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_atexit_cb(id, report, NULL);
    return 0;
}
