#pragma once

#include <mutex>
#include <string>

#include <sys/types.h>

namespace fascia {

// What must not outlive the program, however it ends: temporary files and folders that have names,
// and other programs at work.

// Making one of them and listing it happens under this lock, as does taking it off the list:
// nothing is lost sight of in between.
std::unique_lock<std::mutex> lockUnfinished();

void listTemporary(const std::string& path);  // a file, or a folder with files only
void unlistTemporary(const std::string& path);
void listChild(pid_t child);
void unlistChild(pid_t child);

// Ends all children and removes all temporaries, for a program that ends with no time to return
// from where it is. The lock stays taken: nothing new is begun.
void abandonUnfinished();

// Removes a folder that we made and the files in it that we may have written: numbered pictures and
// temporaries. Others, and the folder with them, stay.
void removeOwnFolder(const std::string& path);

// A name for a temporary in a folder that nobody else has: ".fascia-PID-RANDOM.tmp".
std::string temporaryName(const std::string& folder);

// Removes what killed runs have left in a folder: temporaries named as above that no living process
// holds the lock (flock) of. Looks at each folder once.
void sweepTemporaries(const std::string& folder);

}  // namespace fascia
