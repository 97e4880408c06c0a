# SPDX-License-Identifier: Apache-2.0
# Completion of `slewring` in fish. The program itself lists what may stand at the cursor (slewring --complete); the
# first line of its answer names the kind of files that fit too.
function __slewring_complete
    set -l words (commandline -opc) (commandline -ct)
    set -l answer ($words[1] --complete $words[2..-1] 2> /dev/null)
    test (count $answer) -gt 0; or return
    printf '%s\n' $answer[2..-1]
    set -l kind (string split ' ' -- $answer[1])
    set -l typed (string replace -r '^--[^=]*=' '' -- $words[-1])
    switch $kind[1]
        case any
            __fish_complete_path $typed
        case folders
            for file in (__fish_complete_path $typed)
                set -l path (string split -f 1 \t -- $file)
                string match -q '*/' -- $path; and printf '%s\n' $file
                for suffix in $kind[2..-1]
                    string match -q "*$suffix" -- $path; and printf '%s\n' $file
                end
            end
    end
end

complete -c slewring -f -a '(__slewring_complete)'
