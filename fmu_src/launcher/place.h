/* Texts that are UTF-8, and where the slave lies: from the host's URI, or from where this library was unzipped.  Included once. */

/* Length of the UTF-8 character at `at`; 0 where there is none. */
static size_t utf8(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    size_t n = b[0] < 0x80 ? 1 : b[0] >= 0xc2 && b[0] < 0xe0 ? 2 : b[0] >= 0xe0 && b[0] < 0xf0 ? 3 : b[0] >= 0xf0 && b[0] < 0xf5 ? 4 : 0;
    for (size_t k = 1; k < n; k++)
        if ((b[k] & 0xc0) != 0x80)
            return 0;
    if ((b[0] == 0xe0 && b[1] < 0xa0) || (b[0] == 0xed && b[1] > 0x9f) || (b[0] == 0xf0 && b[1] < 0x90) || (b[0] == 0xf4 && b[1] > 0x8f))
        return 0;
    return n;
}

/* A copy in which every byte that is no UTF-8 is a question mark. */
static char *as_utf8(const char *text)
{
    char *copy = strdup(text ? text : "");
    for (char *at = copy; at && *at;) {
        size_t n = utf8(at);
        if (n == 0)
            *at = '?';
        at += n ? n : 1;
    }
    return copy;
}

static int is_utf8(const char *text)
{
    for (size_t n; *text; text += n)
        if ((n = utf8(text)) == 0)
            return 0;
    return 1;
}

static int hexadecimal(char digit) { return isdigit((unsigned char)digit) ? digit - '0' : tolower((unsigned char)digit) - 'a' + 10; }

/* The path in a URI file:/path, file:///path or file://host/path, or a plain path, without a slash at its end. */
static char *path_of(const char *uri)
{
    char *path = strdup(uri ? uri : ""), *to = path;
    if (!path)
        return NULL;
    if (strncasecmp(path, "file:", 5) == 0) {
        const char *from = path + 5;
        if (strncmp(from, "//", 2) == 0) {
            const char *root = strchr(from + 2, '/');
            from = root ? root : from + 2;
        }
        for (; *from; from++)
            if (*from == '%' && isxdigit((unsigned char)from[1]) && isxdigit((unsigned char)from[2])) {
                *to++ = (char)(16 * hexadecimal(from[1]) + hexadecimal(from[2]));
                from += 2;
            } else
                *to++ = *from;
        *to = 0;
    }
    for (size_t n = strlen(path); n > 1 && path[n - 1] == '/'; n--)
        path[n - 1] = 0;
    return path;
}

static int holds_the_slave(const char *folder)
{
    char file[4096];
    int n = snprintf(file, sizeof file, "%s/slavemodule.txt", folder);
    return *folder && n < (int)sizeof file && access(file, R_OK) == 0;
}

/* `up` folders above this library, and `below` from there */
static void beside(int up, const char *below, char path[4096])
{
    Dl_info here = {0};
    char real[4096] = "";
    if (dladdr((void *)beside, &here) && here.dli_fname && strlen(here.dli_fname) < sizeof real && !realpath(here.dli_fname, real))
        snprintf(real, sizeof real, "%s", here.dli_fname);
    for (int k = 0; k < up; k++) {
        char *slash = strrchr(real, '/');
        if (slash)
            *slash = 0;
    }
    if (snprintf(path, 4096, "%s/%s", real, below) >= 4096)
        *path = 0;
}

/* Where the slave lies: as the host says, or where this library was unzipped.  NULL and a message where it is not to be found. */
static char *find_resources(const Log *log, const char *uri)
{
    char own[4096], *path = path_of(uri);
    beside(3, "resources", own);
    if (path && !holds_the_slave(path) && holds_the_slave(own)) {
        free(path);
        path = strdup(own);
    }
    const char *wrong = !path || !holds_the_slave(path) ? "the folder resources of the unzipped FMU. Unzip it, and give the URI of that folder."
        : !is_utf8(path)                                ? "UTF-8. Unzip the FMU into another folder."
        : strstr(path, "%20")                           ? "without %20 in a name. Unzip the FMU into another folder."
                                                        : NULL;
    if (wrong) {
        char *shown = as_utf8(uri);
        say(log, fmi2Error, "resource location = '%.500s': must be %s", shown ? shown : "", wrong);
        free(shown);
        free(path);
        return NULL;
    }
    return path;
}
