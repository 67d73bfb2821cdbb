# Completion of servomill for fish: the program itself knows its commands, options, keys and scenarios.
function __servomill_candidates
    set -l words (commandline -opc) (commandline -ct)
    for line in ($words[1] --complete $words[2..-1] 2>/dev/null)
        if test "$line" = ":files"
            __fish_complete_path (commandline -ct)
        else
            echo $line
        end
    end
end
complete -c servomill -f -a '(__servomill_candidates)'
