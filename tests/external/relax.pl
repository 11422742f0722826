#!/usr/bin/perl
# A solver without an SDK, written from experiments/external/README.md alone: symplectic Euler, sweeps there and back.
use strict; use warnings; use JSON::PP; use Time::HiRes qw(clock);
binmode STDIN; binmode STDOUT; $| = 1;
my ($scene, $params, @x, @v);
sub say_ { print encode_json($_[0]), "\n", $_[1] // "" }
while (defined(my $line = <STDIN>)) {
  my $r = eval { decode_json($line) };
  if (!$r || ref $r ne 'HASH' || !defined $r->{op}) { say_({error => "no request"}); next }
  my $op = $r->{op};
  my $ok = eval {
    if ($op eq 'hello') {
      say_({protocol => "taut-solver/1", name => "relax-perl", version => "1", summary => "Symmetric sweeps in Perl",
            params => {iterations => {type => "integer", min => 1, max => 1000, default => 8, doc => "Sweeps, there and back by turns"}}});
    } elsif ($op eq 'scene') {
      open my $f, '<', $r->{file} or die "$r->{file}: $!\n"; local $/; $scene = decode_json(<$f>); $params = $r->{params};
      my @cannot;
      push @cannot, "colliders are not known" if @{$scene->{colliders}};
      push @cannot, "wind is not known" if $scene->{wind};
      push @cannot, "moving pins are not known" if @{$scene->{pin_motions}};
      push @cannot, "self-collision is not known" if $scene->{self_collision};
      if (@cannot) { say_({cannot => \@cannot}) }
      else { say_({vertices => $scene->{vertices}, plan => [{pass => "links", items => scalar @{$scene->{links}}, repeats => $params->{iterations}, projections => JSON::PP::true}],
                   settings => {precision => "double", order => "there and back"}}) }
    } elsif ($op eq 'load') {
      read(STDIN, my $bytes, $r->{bytes}) == $r->{bytes} or exit 0;
      my @all = unpack("d<*", $bytes); my $n = @all / 2; @x = @all[0 .. $n - 1]; @v = @all[$n .. $#all];
      say_({});
    } elsif ($op eq 'step') {
      my $t0 = clock();
      step($r->{dt}) for 1 .. $r->{count};
      say_({cpu_ns => int(1e9 * (clock() - $t0))});
    } elsif ($op eq 'store') {
      my $bytes = pack("d<*", @x, @v); say_({bytes => length $bytes}, $bytes);
    } else { say_({error => "unknown op $op"}) }
    1;
  };
  if (!$ok) { my $e = $@; chomp $e; say_({error => "$e"}) }
}
sub step {
  my $h = shift; my ($w, $g) = ($scene->{inverse_mass}, $scene->{gravity}); my @old = @x; my $keep = exp(-$scene->{damping} * $h);
  for my $i (0 .. $#$w) { next unless $w->[$i] > 0;
    for my $k (0 .. 2) { my $j = 3 * $i + $k; $v[$j] = $keep * $v[$j] + $h * $g->[$k]; $x[$j] += $h * $v[$j] } }
  my @links = @{$scene->{links}};
  for my $n (1 .. $params->{iterations}) {
    for my $l ($n % 2 ? @links : reverse @links) {
      my ($a, $b, $rest) = @$l; my $sum = $w->[$a] + $w->[$b]; next unless $sum > 0;
      my ($i, $j) = (3 * $a, 3 * $b);
      my @d = map { $x[$j + $_] - $x[$i + $_] } 0 .. 2; my $len = sqrt($d[0]**2 + $d[1]**2 + $d[2]**2); next unless $len > 0;
      my $s = ($len - $rest) / ($len * $sum);
      for (0 .. 2) { $x[$i + $_] += $w->[$a] * $s * $d[$_]; $x[$j + $_] -= $w->[$b] * $s * $d[$_] } } }
  for my $i (0 .. $#$w) { next unless $w->[$i] > 0; for my $j (3 * $i .. 3 * $i + 2) { $v[$j] = ($x[$j] - $old[$j]) / $h } }
}
