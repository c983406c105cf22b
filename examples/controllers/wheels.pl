#!/usr/bin/perl
# A controller in Perl: turns to the goal, then drives there, by the speeds of its two wheels.
use strict;
use warnings;
use JSON::PP;

$| = 1;    # every answer is sent at once
my $json     = JSON::PP->new;
my $robot    = $json->decode( scalar <STDIN> )->{robot};
my $pi       = atan2( 0, -1 );
while ( my $line = <STDIN> ) {
    my $seen = $json->decode($line);
    my ( $dx, $dy ) = map { $seen->{goal}[$_] - $seen->{position}[$_] } 0, 1;
    my $error = atan2( $dy, $dx ) - $seen->{heading};
    $error -= 2 * $pi while $error > $pi;
    $error += 2 * $pi while $error < -$pi;
    my $distance = sqrt( $dx**2 + $dy**2 );
    my $speed    = abs($error) > 0.5 ? 0 : $distance < 0.6 ? $distance : 0.6;
    my $half     = 2 * $error * $robot->{track} / 2;
    my @wheels   = map { $_ / $robot->{wheel_radius} } $speed - $half, $speed + $half;
    print $json->encode( { wheels => \@wheels } ), "\n";
}
