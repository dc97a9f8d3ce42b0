!> Fewer teams when ordinates become few: those that are left move together.
module rwmf_spectrum_fast_compaction
   use rwmf_spectrum_fast_types, only: seats, team_t
   use rwmf_spectrum_fast_shared_data, only: kinds
   use rwmf_spectrum_fast_lane_pool, only: lane_of, pool_t, team_of
   implicit none
   private

   public :: gather_up

contains

   !> Move whoever is ready from the emptiest team of a kind to free places of others, if there are
   !> enough.
   pure subroutine gather_up(pool)
      type(pool_t), intent(inout) :: pool
      integer :: members(size(pool%team))
      integer :: k, kind

      do k = 1, size(pool%team)
         members(k) = count(pool%ordinate((k - 1)*seats + 1:k*seats)%task /= 0)
      end do
      do kind = 1, kinds
         associate (is_alike => members > 0 .and. pool%kind == kind)
            if (count(is_alike) <= (sum(members, is_alike) + seats - 1)/seats) cycle
            call dissolve(minloc(members, dim=1, mask=is_alike), is_alike, pool)
         end associate
      end do
   end subroutine gather_up

   !> Move the members of a team.
   pure subroutine dissolve(from, is_alike, pool)
      integer, intent(in) :: from
      logical, intent(in) :: is_alike(:)
      !! (teams) has members, and steps of the same kind
      type(pool_t), intent(inout) :: pool
      integer :: i, free

      free = 1
      do i = (from - 1)*seats + 1, from*seats
         if (.not. pool%team(from)%ready(lane_of(i)) > 0) cycle
         do while (pool%ordinate(free)%task /= 0 .or. .not. is_alike(team_of(free)) &
            .or. team_of(free) == from)
            free = free + 1
            if (free > size(pool%ordinate)) return
         end do
         call move(i, free, pool)
      end do
   end subroutine dissolve

   !> An ordinate that is ready changes its place.
   pure subroutine move(from, to, pool)
      integer, intent(in) :: from
      !! slot
      integer, intent(in) :: to
      !! slot
      type(pool_t), intent(inout) :: pool

      pool%ordinate(to) = pool%ordinate(from)
      pool%ordinate(from)%task = 0
      call copy_lane(pool%team(team_of(from)), lane_of(from), lane_of(to), pool%team(team_of(to)))
      associate (team => pool%team(team_of(from)), i => lane_of(from))
         team%ready(i) = 0
         team%at(i) = 1
         team%stop(i) = huge(1)
      end associate
      pool%present(team_of(from)) = pool%present(team_of(from)) - 1
      pool%present(team_of(to)) = pool%present(team_of(to)) + 1
      pool%is_called(team_of(to)) = .true.
   end subroutine move

   !> What a lane carries from step to step, and its constants.
   pure subroutine copy_lane(source, from, to, team)
      type(team_t), intent(in) :: source
      integer, intent(in) :: from
      !! lane
      integer, intent(in) :: to
      !! lane
      type(team_t), intent(inout) :: team

      team%now%v(to) = source%now%v(from)
      team%now%w(to) = source%now%w(from)
      team%now%n(to) = source%now%n(from)
      team%now%s(to) = source%now%s(from)
      team%now%drive(to) = source%now%drive(from)
      team%now%doubt(to) = source%now%doubt(from)
      team%ready(to) = source%ready(from)
      team%v_max(to) = source%v_max(from)
      team%worst(to) = source%worst(from)
      team%at(to) = source%at(from)
      team%stop(to) = source%stop(from)
      associate (new => team%rate, old => source%rate)
         new%h(to) = old%h(from)
         new%per_h(to) = old%per_h(from)
         new%side(to) = old%side(from)
         new%m2(to) = old%m2(from)
         new%m3(to) = old%m3(from)
         new%damping(to) = old%damping(from)
         new%stiffness(to) = old%stiffness(from)
         new%keep(to) = old%keep(from)
         new%coef(to, :, :) = old%coef(from, :, :)
         new%weight(to, :) = old%weight(from, :)
      end associate
   end subroutine copy_lane

end module rwmf_spectrum_fast_compaction
