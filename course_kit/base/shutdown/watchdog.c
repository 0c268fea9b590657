/* A thread that keeps this process from hanging while a native call holds Python's lock.

   rclpy holds the lock in most calls into ROS, so no code of Python's can help a process that waits there:
   no signal handler runs, and no other thread. This thread needs no lock. It does four things:

   - It heals dead segments. Fast DDS makes a file in /dev/shm in four steps: it creates the file, sets its length,
     maps it, writes a state into its first word. A process that is killed in between leaves a file that never gets
     ready. Everybody who opens it waits without an end (boost::interprocess, managed_open_or_create_impl). Those who
     wait get an exception if the state says that the file is corrupted, and make it anew.
   - It ends endless recoveries. A writer that meets a port whose reader was killed in the midst of a message forgets
     that message, but with the port's mutex locked twice: it waits 1 s for itself, and begins anew (Fast DDS issue
     6485). It goes on if nobody seems to read in the midst of a message any more.
   - It gives back what the dead hold: the mutex of a port, for which each message would wait a second.
   - It ends the process when its time has come: so long after a signal, or when an exit timer is over. */

#define _GNU_SOURCE
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/futex.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#define FOLDER "/dev/shm"
#define PREFIX "fastrtps_"
#define LOCK_SUFFIX "_el"
#define PORT_PREFIX PREFIX "port"
#define SEMAPHORE_PREFIX "sem.fastrtps_port"
enum { READY = 2, CORRUPTED = 3 }; /* of boost's states; 0 is uninitialized, 1 initializing */
#define HEX_DIGITS 16              /* of the name of a data segment */
#define PERIOD_MS 250              /* between two looks at the folder */
#define MAPPINGS_MS 1000           /* between two looks at the mappings of this process, which take the kernel longer */
#define NEW_S 1.0                  /* a younger file may still be made, which takes microseconds, by one who has it */
#define UNUSED_S 0.1               /* the same where nobody has it */
#define REMEMBERED 16384           /* segments that were ready at an earlier look */
#define MEMORY_S 2.0               /* where numbers of files are used again, one may be of another file after that */
#define PROCESS_FOLDER 280         /* bytes for the path of a process in /proc */
#define SMALLEST 4096              /* a file without a length gets this one, so that it can be mapped */

/* A port as Fast DDS 2.14 makes it: where its parts are, in bytes, and the bits in them. */
enum { NUMBER = 0x114, FLAGS = 0x12c, MUTEX = 0x5170 };
enum { LISTENERS = 0x5198, LISTENER_SIZE = 20, LISTENERS_LOOKED_AT = 64 };
enum { IS_IN_ORDER = 1, IS_PROCESSING = 4, SHARED = 128 }; /* SHARED: a mutex's kind */
#define SUSPECTS 32

static double now(clockid_t clock) {
    struct timespec time;
    clock_gettime(clock, &time);
    return time.tv_sec + time.tv_nsec / 1e9;
}

static int ends_with(const char *text, const char *end) {
    size_t length = strlen(text), end_length = strlen(end);
    return length >= end_length && strcmp(text + length - end_length, end) == 0;
}

/* ---- Dead segments */

static int some_are_hidden; /* whether others share the folder whose processes are not seen, as in a sandbox */

/* Whether this process lacked the means to open a file, such as a free descriptor. */
static int lacks_means(void) { return errno == EMFILE || errno == ENFILE || errno == ENOMEM; }

/* Whether a process, given by its folder in /proc, has the file open or mapped; 0 if it does not let that be seen.
   1 if this process lacks the means to look: the file of a maker who is not seen would be taken from it. */
static int uses(const char *process, const char *path) {
    char name[300], line[1024];
    struct stat owner_of;
    int found = 0;
    if (stat(process, &owner_of) || owner_of.st_uid != geteuid()) return 0; /* it has ended, or is another user's */
    snprintf(name, sizeof name, "%s/maps", process);
    FILE *maps = fopen(name, "re");
    if (!maps) return lacks_means();
    while (!found && fgets(line, sizeof line, maps)) {
        line[strcspn(line, "\n")] = 0;
        found = ends_with(line, path); /* a removed file of that name is another one: "… (deleted)" */
    }
    fclose(maps);
    snprintf(name, sizeof name, "%s/fd", process);
    DIR *files = found ? NULL : opendir(name);
    struct dirent *link;
    if (!found && !files) return lacks_means();
    while (files && !found && (link = readdir(files))) {
        ssize_t length = readlinkat(dirfd(files), link->d_name, line, sizeof line - 1);
        found = length == (ssize_t)strlen(path) && !strncmp(line, path, length);
    }
    if (files) closedir(files);
    return found;
}

/* The state of a thread, given by its folder in /proc, as a letter; ' ' if there is none. */
static char state_of(const char *thread) {
    char name[300], line[1024], state = ' ';
    snprintf(name, sizeof name, "%s/stat", thread);
    FILE *file = fopen(name, "re");
    if (file && fgets(line, sizeof line, file) && strrchr(line, ')')) state = strrchr(line, ')')[2];
    if (file) fclose(file);
    return state;
}

/* Goes on in /proc to the next process that has the file, and writes its folder; 0 if there is none any more. */
static int next_user(DIR *processes, const char *path, char folder[PROCESS_FOLDER]) {
    struct dirent *entry;
    while ((entry = readdir(processes))) {
        if (!isdigit((unsigned char)entry->d_name[0])) continue;
        snprintf(folder, PROCESS_FOLDER, "/proc/%s", entry->d_name);
        if (uses(folder, path)) return 1;
    }
    return 0;
}

/* Which processes of this user have the file: its maker may be among them. */
enum users { NOBODY, SOMEBODY, A_STOPPED_ONE };

static enum users users_of(const char *path) {
    DIR *processes = opendir("/proc");
    char folder[PROCESS_FOLDER];
    enum users users = processes ? NOBODY : SOMEBODY;
    while (processes && users != A_STOPPED_ONE && next_user(processes, path, folder)) {
        char state = state_of(folder);
        users = state == 'T' || state == 't' ? A_STOPPED_ONE : SOMEBODY; /* as after Ctrl-Z */
    }
    if (processes) closedir(processes);
    return users;
}

/* Segments that were ready, by inode. They stay ready, so they are not read at each look: with the segments of a
   thousand dead processes that takes 3 % of a core. */
static _Atomic ino_t ready[REMEMBERED];

static void remember_ready(ino_t file) { atomic_store(&ready[file % REMEMBERED], file); }

static int is_known_ready(ino_t file) { return atomic_load(&ready[file % REMEMBERED]) == file; }

static void forget_ready(void) {
    static _Atomic double next;
    double time = now(CLOCK_MONOTONIC);
    if (time < atomic_load(&next)) return;
    for (int index = 0; index < REMEMBERED; index++) atomic_store(&ready[index], 0);
    atomic_store(&next, time + MEMORY_S);
}

/* The inode of the file if it is a segment of this user that is not ready, and that nobody can be making any more;
   else 0. */
static ino_t dead_one(const char *path) {
    struct stat found;
    unsigned state;
    if (lstat(path, &found) || !S_ISREG(found.st_mode) || found.st_uid != geteuid()) return 0;
    double age = now(CLOCK_REALTIME) - (found.st_mtim.tv_sec + found.st_mtim.tv_nsec / 1e9);
    if (age < (some_are_hidden ? NEW_S : UNUSED_S)) return 0;
    if (found.st_size != 0) {
        int file = open(path, O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
        int is_read = file >= 0 && read(file, &state, sizeof state) == sizeof state;
        if (file >= 0) close(file);
        if (is_read && state >= READY) remember_ready(found.st_ino);
        if (!is_read || state >= READY) return 0;
    }
    enum users users = users_of(path);
    return users == NOBODY || (users == SOMEBODY && age >= NEW_S) ? found.st_ino : 0;
}

/* Heals the file if it is a dead segment of this user; returns 1 if it was one. */
static int heal(const char *name) {
    char path[sizeof FOLDER + 256];
    struct stat opened, named;
    int healed = 0;
    snprintf(path, sizeof path, FOLDER "/%s", name);
    ino_t dead = dead_one(path);
    if (!dead) return 0;
    int file = open(path, O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return 0;
    /* Another process may have healed the file while this one looked for its users, and a third one may be making it
       anew: that file is another one. The lock keeps two that heal from each other. */
    if (!flock(file, LOCK_EX | LOCK_NB) && !fstat(file, &opened) && !lstat(path, &named) && opened.st_ino == dead &&
        named.st_ino == dead && (opened.st_size > 0 || !ftruncate(file, SMALLEST))) {
        _Atomic unsigned *word = mmap(NULL, sizeof *word, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        if (word != MAP_FAILED) {
            unsigned seen = atomic_load(word);
            if (seen < READY && unlink(path) == 0) healed = atomic_compare_exchange_strong(word, &seen, CORRUPTED);
            munmap((void *)word, sizeof *word);
        }
    }
    close(file);
    return healed;
}

/* Whether a port's semaphore, which is this user's, is taken and nobody has it. */
static int is_held_by_the_dead(const char *path) {
    struct stat found;
    ino_t first = 0; /* who removes it meanwhile makes another one */
    for (int look = 0; look < 2; look++) { /* who held it at the first look may have given it back meanwhile */
        unsigned value = 1;
        int file = lstat(path, &found) || !S_ISREG(found.st_mode) || found.st_uid != geteuid()
                       ? -1
                       : open(path, O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
        if (file < 0 || read(file, &value, sizeof value) != sizeof value) value = 1;
        if (file >= 0) close(file);
        if (value != 0 || (look == 0 && users_of(path) != NOBODY) || (look == 1 && found.st_ino != first)) return 0;
        first = found.st_ino;
    }
    return 1;
}

/* ---- Ports that hold those who send */

/* A port's memory: a file, or a mapping of this process where the file has been removed. */
struct port {
    int file;         /* -1: a mapping */
    size_t address;   /* of the mapping */
    unsigned number;  /* by its name */
    unsigned long id; /* inode of the file, or address of the mapping */
};

/* The mutex of a port, as glibc has it. */
struct mutex {
    _Atomic unsigned lock;
    unsigned count;
    _Atomic int holder; /* a thread's id */
    _Atomic unsigned users;
    int kind;
};

/* A port that is out of order, and the thread that holds its mutex. */
struct suspect {
    unsigned long port;
    int holder;
};

/* The mapping may go at any moment, so the kernel reads it and writes it. */
static int read_port(const struct port *port, size_t offset, void *to, size_t size) {
    struct iovec here = {to, size}, there = {(char *)port->address + offset, size};
    if (port->file >= 0) return pread(port->file, to, size, offset) == (ssize_t)size;
    return process_vm_readv(getpid(), &here, 1, &there, 1, 0) == (ssize_t)size;
}

static void write_port(const struct port *port, size_t offset, unsigned char value) {
    struct iovec here = {&value, 1}, there = {(char *)port->address + offset, 1};
    ssize_t written = port->file >= 0 ? pwrite(port->file, &value, 1, offset)
                                      : process_vm_writev(getpid(), &here, 1, &there, 1, 0);
    (void)written; /* it has been unmapped */
}

/* The suspects of one look, and of the one before it. */
struct looks {
    struct suspect before[SUSPECTS], found[SUSPECTS];
    int count;
};

static void end_look(struct looks *looks) {
    memcpy(looks->before, looks->found, sizeof looks->before);
    memset(looks->found, 0, sizeof looks->found);
    looks->count = 0;
}

/* Whether no thread of this id lives. In another namespace of process ids it may have that id nevertheless. */
static int is_gone(int thread, const char *path) {
    char folder[PROCESS_FOLDER], name[300], line[1024];
    snprintf(folder, sizeof folder, "/proc/%d", thread);
    int lives = kill(thread, 0) ? errno != ESRCH : state_of(folder) != 'Z'; /* its parent may not have taken note yet */
    DIR *processes = some_are_hidden || lives ? NULL : opendir("/proc");
    int gone = processes != NULL;
    while (processes && gone && next_user(processes, path, folder)) {
        snprintf(name, sizeof name, "%s/status", folder);
        FILE *file = fopen(name, "re");
        while (file && fgets(line, sizeof line, file))
            if (!strncmp(line, "NSpid:", 6) && strtok(line, "\t") && strtok(NULL, "\t") && strtok(NULL, "\t")) gone = 0;
        if (file) fclose(file);
    }
    if (processes) closedir(processes);
    return gone;
}

/* Gives a port's mutex back in the place of the dead thread that holds it. */
static void give_back(const struct port *port, int holder) {
    const size_t size = MUTEX + sizeof(struct mutex);
    char *memory = port->file >= 0 ? mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, port->file, 0)
                                   : mremap((void *)port->address, 0, size, MREMAP_MAYMOVE); /* the same memory again */
    if (memory == MAP_FAILED) return;
    struct mutex *mutex = (struct mutex *)(memory + MUTEX);
    const unsigned *number = (const unsigned *)(memory + NUMBER);
    /* With another number it is something else that has been mapped there meanwhile. With another holder the mutex has
       been given back, by another process. */
    if (*number == port->number && atomic_compare_exchange_strong(&mutex->holder, &holder, 0)) {
        atomic_fetch_sub(&mutex->users, 1);
        atomic_store(&mutex->lock, 0);
        syscall(SYS_futex, &mutex->lock, FUTEX_WAKE, INT_MAX, NULL, NULL, 0);
    }
    munmap(memory, size);
}

/* Has those go on who wait for a port's mutex: it is given back if a dead thread holds it, and a recovery comes to its
   end if one thread holds the mutex of a port out of order at two looks. */
static void free_port(const struct port *port, const char *path, struct looks *looks) {
    struct mutex mutex;
    unsigned number, flags;
    if (!read_port(port, NUMBER, &number, sizeof number) || number != port->number ||
        !read_port(port, FLAGS, &flags, sizeof flags) || !read_port(port, MUTEX, &mutex, sizeof mutex) ||
        mutex.kind != SHARED || mutex.lock == 0 || mutex.holder <= 0)
        return;
    if (is_gone(mutex.holder, path)) {
        /* The dead may have left the port in the midst of a change: those who wait for it make it anew. */
        write_port(port, FLAGS, flags & ~IS_IN_ORDER);
        give_back(port, mutex.holder);
    }
    if (flags & IS_IN_ORDER) return;
    int is_known = 0;
    for (int index = 0; index < SUSPECTS; index++)
        is_known |= looks->before[index].port == port->id && looks->before[index].holder == mutex.holder;
    if (looks->count < SUSPECTS) looks->found[looks->count++] = (struct suspect){port->id, mutex.holder};
    for (size_t index = 0; is_known && index < LISTENERS_LOOKED_AT; index++) {
        size_t offset = LISTENERS + index * LISTENER_SIZE;
        unsigned char state;
        if (read_port(port, offset, &state, 1) && state & IS_PROCESSING)
            write_port(port, offset, state & ~IS_PROCESSING);
    }
}

/* Frees the ports of this user, whichever process waits for them. */
static void free_ports(void) {
    static struct looks looks;
    char rest[2], path[sizeof FOLDER + 256];
    struct port port;
    DIR *folder = opendir(FOLDER);
    struct dirent *entry;
    while (folder && (entry = readdir(folder))) {
        struct stat opened;
        if (sscanf(entry->d_name, PORT_PREFIX "%u%1s", &port.number, rest) != 1) continue;
        port.file = openat(dirfd(folder), entry->d_name, O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
        if (port.file < 0) continue;
        if (!fstat(port.file, &opened) && opened.st_uid == geteuid()) {
            port.id = opened.st_ino;
            snprintf(path, sizeof path, FOLDER "/%s", entry->d_name);
            free_port(&port, path, &looks);
        }
        close(port.file);
    }
    if (folder) closedir(folder);
    end_look(&looks);
}

/* Frees the ports that have been removed, and that this process still has. */
static void free_removed_ports(void) {
    static struct looks looks;
    char line[1024];
    struct port port = {.file = -1};
    FILE *maps = fopen("/proc/self/maps", "re");
    while (maps && fgets(line, sizeof line, maps)) {
        const char *name = strstr(line, FOLDER "/" PORT_PREFIX);
        if (name && strstr(name, " (deleted)") && sscanf(line, "%zx", &port.address) == 1 &&
            sscanf(name, FOLDER "/" PORT_PREFIX "%u", &port.number) == 1) {
            port.id = port.address;
            line[strcspn(line, "\n")] = 0;
            free_port(&port, name, &looks);
        }
    }
    if (maps) fclose(maps);
    end_look(&looks);
}

/* ---- All that is healed */

/* Heals all dead segments of this user, ports and data; returns how many there were.

   The semaphore that a port is made under goes too if it is held by the dead: Fast DDS would take it over after 2 s. */
int watchdog_heal(void) {
    DIR *folder = opendir(FOLDER);
    struct dirent *entry;
    int healed = 0;
    forget_ready();
    while (folder && (entry = readdir(folder))) {
        if (is_known_ready(entry->d_ino)) continue;
        if (!strncmp(entry->d_name, PREFIX, strlen(PREFIX)) && !ends_with(entry->d_name, LOCK_SUFFIX))
            healed += heal(entry->d_name);
        if (!some_are_hidden && !strncmp(entry->d_name, SEMAPHORE_PREFIX, strlen(SEMAPHORE_PREFIX))) {
            char path[sizeof FOLDER + 256];
            snprintf(path, sizeof path, FOLDER "/%s", entry->d_name);
            if (is_held_by_the_dead(path)) unlink(path);
        }
    }
    if (folder) closedir(folder);
    return healed;
}

/* Has it take into account that others share the folder whose processes are not seen. */
void watchdog_expect_hidden(void) { some_are_hidden = 1; }

/* ---- The end of the process */

/* Removes the data segments that this process has made; it holds the lock of each open. */
static void remove_own_segments(void) {
    DIR *files = opendir("/proc/self/fd");
    struct dirent *entry;
    const char *start = FOLDER "/" PREFIX;
    const size_t length = strlen(start) + HEX_DIGITS;
    while (files && (entry = readdir(files))) {
        char path[512];
        ssize_t size = readlinkat(dirfd(files), entry->d_name, path, sizeof path - 1);
        if (size < 0) continue;
        path[size] = 0;
        if (strncmp(path, start, strlen(start)) || strspn(path + strlen(start), "0123456789abcdef") != HEX_DIGITS ||
            strcmp(path + length, LOCK_SUFFIX))
            continue;
        unlink(path);
        path[length] = 0;
        unlink(path);
    }
    if (files) closedir(files);
}

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static double deadline;      /* in seconds of CLOCK_MONOTONIC; 0: none */
static int status;           /* the exit status at the deadline */
static int signals[2];       /* a pipe: Python's own signal handler in C writes the number of each signal into it */
static int heir = -1;        /* a socket that gets the numbers, too; -1: none */
static unsigned long ending; /* the signals that end the process, as bits */
static double patience;      /* seconds from such a signal to the end */
static pid_t owner;

static void end_at(double time, int exit_status) {
    if (deadline == 0 || time < deadline) deadline = time;
    status = exit_status;
}

static void take_signals(void) {
    unsigned char number;
    while (read(signals[0], &number, 1) == 1) {
        if (number < 64 && patience > 0 && ending >> number & 1 && deadline == 0)
            end_at(now(CLOCK_MONOTONIC) + patience, 128 + number);
        if (heir >= 0 && number > 0 && send(heir, &number, 1, MSG_DONTWAIT | MSG_NOSIGNAL) < 0) heir = -1;
    }
}

static void *run(void *nothing) {
    struct pollfd heard = {signals[0], POLLIN, 0};
    double next_look = 0, next_mappings = 0;
    while (1) {
        pthread_mutex_lock(&lock);
        take_signals();
        double time = now(CLOCK_MONOTONIC);
        int is_over = deadline > 0 && time >= deadline, exit_status = status;
        double wait = deadline > 0 && (deadline - time) * 1e3 < PERIOD_MS ? (deadline - time) * 1e3 + 1 : PERIOD_MS;
        pthread_mutex_unlock(&lock);
        if (is_over) {
            remove_own_segments();
            _exit(exit_status);
        }
        if (time >= next_look) {
            watchdog_heal();
            free_ports();
            next_look = time + PERIOD_MS / 1e3;
        }
        if (time >= next_mappings) {
            free_removed_ports();
            next_mappings = time + MAPPINGS_MS / 1e3;
        }
        poll(&heard, 1, wait);
    }
    return nothing;
}

/* Takes signals at once, while the other thread may be looking through a folder: the programs of a launch may have
   ended by the time it is done, and then the launch would end as if nobody had interrupted it. */
static void *relay(void *nothing) {
    struct pollfd heard = {signals[0], POLLIN, 0};
    while (1) {
        poll(&heard, 1, -1);
        pthread_mutex_lock(&lock);
        take_signals();
        pthread_mutex_unlock(&lock);
    }
    return nothing;
}

/* Starts a thread, to which no signals go but those of its own faults, so that it can be told where one happened.
   Returns 0, or -1 with errno. */
static int start(void *(*work)(void *)) {
    static const int faults[] = {SIGBUS, SIGSEGV, SIGILL, SIGFPE};
    pthread_t thread;
    sigset_t all, before;
    sigfillset(&all); /* signals go to the threads of the program */
    for (size_t index = 0; index < sizeof faults / sizeof *faults; index++) sigdelset(&all, faults[index]);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    errno = pthread_create(&thread, NULL, work, NULL);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return errno ? -1 : pthread_detach(thread);
}

/* A forked child has none of its parent's threads, but the lock as one of them may have held it. */
static void forget_lock(void) { lock = (pthread_mutex_t)PTHREAD_MUTEX_INITIALIZER; }

/* Starts the thread, once in a process; returns the end of the pipe for signals, or -1 with errno. */
int watchdog_begin(void) {
    static int handles_forks;
    pthread_mutex_lock(&lock);
    if (owner != getpid()) {
        if (!handles_forks) handles_forks = !pthread_atfork(NULL, NULL, forget_lock);
        int failed = pipe2(signals, O_NONBLOCK | O_CLOEXEC);
        deadline = patience = 0;
        heir = -1;
        if (failed || start(run)) signals[1] = -1;
        else owner = getpid();
    }
    pthread_mutex_unlock(&lock);
    return signals[1];
}

/* Has each of the signals, given as bits, end the process so many seconds after it; 0: no longer. */
void watchdog_end_after_signals(unsigned long numbers, double seconds) {
    pthread_mutex_lock(&lock);
    ending = numbers;
    patience = seconds;
    pthread_mutex_unlock(&lock);
}

/* Has the number of each signal go into this socket, too, from now on; -1: into none. Without another thread it goes
   there after a look. */
void watchdog_hand_on(int descriptor) {
    static pid_t relaying;
    pthread_mutex_lock(&lock);
    heir = descriptor;
    if (heir >= 0 && relaying != getpid() && !start(relay)) relaying = getpid();
    pthread_mutex_unlock(&lock);
}

/* Ends the process in so many seconds with an exit status; sooner if a signal has set an earlier end. */
void watchdog_end_in(double seconds, int exit_status) {
    pthread_mutex_lock(&lock);
    end_at(now(CLOCK_MONOTONIC) + seconds, exit_status);
    pthread_mutex_unlock(&lock);
    unsigned char nothing = 0;
    if (write(signals[1], &nothing, 1) < 0) return; /* the thread waits for less time from now on */
}

/* Ends the process now. What was interrupted while it made a participant has left it to nobody, in shared memory. */
void watchdog_end_now(int exit_status) {
    remove_own_segments();
    _exit(exit_status);
}

/* Lets the process live, whatever was to end it. */
void watchdog_let_live(void) {
    pthread_mutex_lock(&lock);
    take_signals();
    deadline = 0;
    pthread_mutex_unlock(&lock);
}
