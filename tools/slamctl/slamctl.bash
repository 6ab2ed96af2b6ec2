# bash completion of slamctl; install as /usr/share/bash-completion/completions/slamctl or source it.
_slamctl() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} command="" sub="" word
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    case $word in
      status | doctor | metrics | top | pose | inject | map | grid | trajectory | dump | record) [[ -z $command ]] && command=$word ;;
      save) sub=save ;;
    esac
  done
  case $prev in
    --socket) mapfile -t COMPREPLY < <(compgen -f -- "$cur"); return ;;
    --timeout | --lidar | --rate | --count | --voxel | --box | --for | --interval | --out) return ;;
  esac
  local general="--socket --json --timeout --help" words=""
  case $command in
    "") words="status doctor metrics top pose inject map grid trajectory dump record $general" ;;
    metrics) words=$general ;;
    status) words="--watch --interval --count $general" ;;
    record) words="start stop --max-s --max-mb $general" ;;
    dump | grid) words="--out $general" ;;
    doctor) words="--lidar $general" ;;
    pose) words="--follow --rate --count $general" ;;
    top) words="--once --interval $general" ;;
    inject) words="lidar imu gps none off stuck garbage wrong slow delayed intermittent --for $general" ;;
    map | trajectory)
      if [[ -z $sub ]]; then
        words="save $general"
      elif [[ $cur != -* ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$cur")
        return
      elif [[ $command == map ]]; then
        words="--voxel --box $general"
      else
        words=$general
      fi
      ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
}
complete -o filenames -F _slamctl slamctl
